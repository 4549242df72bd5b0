"""The casting recipe: what to weigh, pour, coat, solder and print, and in which order.

mass = volume (1 + waste) density, split by the mix ratio; the volume is that of the cavity, so it
holds the shrinkage. Numbers of the silicone come from `silicones`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from geometry.body.csg_mesh import closed
from geometry.body.silicones import NEAR, Silicone, elongation, nearest, silicone
from geometry.housing.holder_seat import centred
from geometry.housing.leds import led_items
from geometry.housing.supplies import ADHESIVE, bolts, rim_mm2, supplies
from geometry.mould.castability import Worst
from geometry.mould.gel import gel_step
from geometry.mould.mould_checks import core_removal, part_removal
from geometry.surface.surface import face_areas
from geometry.workshop.opening_words import closing_steps, opening_steps
from workbench.core.design.lighting import LedRing
from workbench.core.design.making import Casting
from workbench.core.result.fabrication import (
    FabricationCheck,
    FabricationPart,
    HousingSet,
    MouldSet,
    PrintItem,
    Recipe,
)
from workbench.core.result.results import Label, Solid


@dataclass(frozen=True, kw_only=True, slots=True)
class WantedMaterial:
    """What a design asks of the silicone of its skin and of the gel behind it."""

    young_MPa: float
    density_g_cm3: float
    """To weigh with where the table of silicones has none."""
    backing_MPa: float
    """Young's modulus of the gel behind a skin that stands off [MPa]; 0 is air."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Mix:
    """A silicone as it is weighed."""

    silicone: Silicone
    pour_ml: float
    mass_g: float
    share_a: float
    """Of part A in the mass [1]."""

    @property
    def part_a_g(self) -> float:
        """Mass of part A."""
        return self.mass_g * self.share_a

    @property
    def part_b_g(self) -> float:
        """Mass of part B."""
        return self.mass_g * (1.0 - self.share_a)


def make_recipe(
    solid: Solid,
    moulds: MouldSet,
    housing: HousingSet,
    *,
    ring: LedRing,
    casting: Casting,
    wanted: WantedMaterial,
) -> Recipe:
    """Everything the workshop needs besides the files.

    Args:
        solid: The bodies of the design.
        moulds: What the skin is cast in.
        housing: The rigid parts.
        ring: The LEDs to solder.
        casting: The silicone and how much of it is wasted.
        wanted: What the design asks of silicone and gel.

    Raises:
        DesignError: If the silicone is not in the table.
    """
    chosen = silicone(casting.silicone)
    density = chosen.density_g_cm3 or wanted.density_g_cm3
    cast_ml = moulds.cast_volume_mm3 / 1000.0
    pour_ml = cast_ml * (1.0 + casting.waste_percent / 100.0)
    mix = Mix(
        silicone=chosen,
        pour_ml=pour_ml,
        mass_g=pour_ml * density,
        share_a=chosen.parts_a / (chosen.parts_a + chosen.parts_b),
    )
    sensing = solid.membrane.faces[solid.membrane.has(Label.OUTER)]
    return Recipe(
        silicone=chosen.name,
        source=chosen.source,
        density_g_cm3=density,
        cast_ml=cast_ml,
        pour_ml=pour_ml,
        part_a_g=mix.part_a_g,
        part_b_g=mix.part_b_g,
        coating_mm2=float(face_areas(solid.membrane.points_mm, sensing).sum()),
        leds=led_items(ring),
        prints=tuple(print_item(part) for part in (*moulds.parts, *housing.parts)),
        steps=_steps(solid, moulds, housing, mix, wanted.backing_MPa),
        checks=_checks(moulds, chosen),
        notice=_notice(chosen, wanted),
        supplies=supplies(solid, moulds, housing, casting, wanted.backing_MPa),
        size_mm=_size_mm(solid, housing),
    )


def _checks(moulds: MouldSet, chosen: Silicone) -> tuple[FabricationCheck, ...]:
    bears = elongation(chosen.name)
    checks = [
        part_removal(motion.part, Worst(motion.strain, motion.strain_at_mm), bears)
        for motion in moulds.motions
        if motion.part != "core"
    ]
    if moulds.release_strain is not None:
        confined = [
            Worst(motion.strain, motion.strain_at_mm)
            for motion in moulds.motions
            if motion.part == "core"
        ]
        strains = [Worst(moulds.release_strain, moulds.release_mm), *confined]
        strain = max(strains, key=lambda worst: worst.value)
        checks.append(core_removal(strain, bears))
    return tuple(checks)


def _placing(housing: HousingSet) -> str:
    """What puts the support in its place on the base."""
    found = {part.name: closed(part.name, part.points_mm, part.faces) for part in housing.parts}
    others = [found[name] for name in ("led_ring_holder", "housing_base") if name in found]
    if "support" in found and centred(found["support"], others):
        return "which centres it"
    return "measure that it is in the middle"


def _size_mm(solid: Solid, housing: HousingSet) -> tuple[float, float, float]:
    """Bounding box of skin and rigid parts [mm]."""
    clouds = [solid.membrane.points_mm, *(part.points_mm for part in housing.parts)]
    x, y, z = (float(size) for size in np.ptp(np.concatenate(clouds), axis=0))
    return x, y, z


def print_item(part: FabricationPart) -> PrintItem:
    """One part as a row of the bill of materials."""
    x, y, z = (float(size) for size in np.ptp(part.points_mm, axis=0))
    return PrintItem(
        name=part.name,
        group=part.group,
        process=part.process,
        volume_mm3=part.volume_mm3,
        size_mm=(x, y, z),
    )


def _notice(chosen: Silicone, wanted: WantedMaterial) -> str:
    words, young_MPa = [], wanted.young_MPa
    off = abs(chosen.young_MPa / young_MPa - 1.0)
    if off > NEAR:
        near = nearest(young_MPa)
        words.append(
            f"the design has E {young_MPa:.3g} MPa, {chosen.name} has "
            f"{chosen.young_MPa:.3g} MPa, {100 * off:.0f} % off; nearest in the table is "
            f"{near.name} with {near.young_MPa:.3g} MPa"
        )
    if chosen.density_g_cm3 is None:
        words.append(
            f"no density of {chosen.name} is on record: masses use the design's "
            f"{wanted.density_g_cm3:g} g/cm3"
        )
    return "; ".join(words)


def _steps(
    solid: Solid,
    moulds: MouldSet,
    housing: HousingSet,
    mix: Mix,
    backing_MPa: float,
) -> tuple[str, ...]:
    chosen, pins = mix.silicone, len(solid.tips_mm)
    life = f", within {chosen.pot_life_min:g} minutes" if chosen.pot_life_min else ""
    steps = [
        f"Print {', '.join(part.name for part in moulds.parts)} and, for the sensor, "
        f"{', '.join(part.name for part in housing.parts)}; wash, cure and sand the cavity.",
        "Coat all mould faces with release agent: printed resin stops platinum silicone from "
        "curing, so bake it or seal it with clear acrylic lacquer first.",
        *closing_steps(moulds.motions, bolts(moulds)[0]),
        f"Weigh {mix.part_a_g:.2f} g of part A and {mix.part_b_g:.2f} g of part B of "
        f"{chosen.name} ({mix.pour_ml:.2f} ml in all), stir slowly and degas under vacuum.",
        f"Fill the mould through the gate{life}, until silicone stands in every vent.",
        f"Let it cure ({chosen.cure} at room temperature), flange up and level.",
        *opening_steps(moulds.motions, hollow=moulds.release_strain is not None),
    ]
    if pins:
        steps.append(f"Dab white silicone paint on the tips of the {pins} pins.")
    steps += [
        "Coat the outside with pigmented silicone paint, reflective or opaque as the optics ask.",
        "Prime the support and bond the skin to it with the same silicone.",
    ]
    # The gap is closed only once the skin is bonded.
    if solid.backing_mm > 0.0 and backing_MPa > 0.0:
        steps.append(gel_step(solid, backing_MPa))
    held = any(part.name == "led_ring_holder" for part in housing.parts)
    if held:
        steps.append(
            "Solder the LEDs in the order of the list and press them into led_ring_holder; put "
            "camera and camera_mount into housing_base from below, then the holder on top."
        )
    else:
        steps.append("Put camera and camera_mount into housing_base from below.")
    if rim_mm2(solid.support):
        steps.append(
            f"Glue the support onto the base: a thin bead of {ADHESIVE} under its rim, "
            f"lower it over the {'holder' if held else 'camera'}, {_placing(housing)}, wipe off "
            "what comes out and cure it."
        )
    if any(part.name.startswith("slider") for part in housing.parts):
        steps.append("Push the sliders through their guides and tie them to the actuators.")
    return tuple(steps)
