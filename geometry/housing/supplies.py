"""What to buy besides silicone, prints and LEDs: camera, bolts, adhesive, release agent, primer.

Bolts are counted at the mould's seams: two parts have one seam with two bolts across both, more
parts have a seam each with one bolt. A bolt is as long as what it clamps, two washers, a nut and a
thread to spare, rounded up to the next standard length. Adhesive is a film under the support's rim.

Leaves out: cables, screws of what the sensor is mounted on.
"""

from __future__ import annotations

import numpy as np

from geometry.mould.gel import gap_ml
from geometry.mould.seams import GRIP_MM
from geometry.surface.surface import face_areas
from workbench.core.design.making import Casting, Housing
from workbench.core.result.fabrication import FabricationPart, HousingSet, MouldSet, SupplyItem
from workbench.core.result.results import Label, LabelledSurface, Solid

NUT_MM = 2.4
"""Height of an M3 nut [mm]. Source: ISO 4032."""
WASHER_MM = 0.5
"""Thickness of an M3 washer [mm]. Source: ISO 7089."""
SPARE_MM = 0.5
"""One pitch of an M3 thread beyond the nut [mm]. Source: ISO 261."""
LENGTHS_MM = (8, 10, 12, 16, 20, 25, 30, 35, 40, 45, 50, 55, 60, 65, 70, 80, 90, 100)
"""Standard lengths of bolts [mm]. Source: ISO 888."""
FILM_MM = 0.1
"""Thickness of the adhesive's film [mm]: what two printed faces leave between them."""
FLAT_COSINE = 0.99
ADHESIVE = "UV-curing clear resin or two-part epoxy"


def camera_module(options: Housing) -> SupplyItem:
    """The camera that the mount is made for."""
    size = (options.camera_width_mm, options.camera_height_mm, options.camera_depth_mm)
    details = " x ".join(f"{x:g}" for x in size) + " mm with its lens"
    return SupplyItem(kind="camera", name="camera module", amount=1, unit="piece", details=details)


def supplies(
    solid: Solid, moulds: MouldSet, housing: HousingSet, casting: Casting, backing_MPa: float
) -> tuple[SupplyItem, ...]:
    """Everything to have at hand, in the order in which it is needed.

    Args:
        backing_MPa: Young's modulus of the gel behind a skin that stands off; 0 is air.
    """
    membrane = solid.membrane
    inner_mm2 = _area_mm2(membrane, Label.INNER)
    found = [
        SupplyItem(
            kind="release agent",
            name="release agent for silicone",
            amount=float(face_areas(membrane.points_mm, membrane.faces).sum()),
            unit="mm2",
            details="on every face of the mould that the silicone meets",
        ),
        *_bolts(moulds),
        SupplyItem(
            kind="primer",
            name="silicone primer",
            amount=inner_mm2,
            unit="mm2",
            details=f"between support and {casting.silicone}",
        ),
    ]
    if solid.backing_mm > 0.0 and backing_MPa > 0.0:
        details = f"behind the skin, E {backing_MPa:g} MPa"
        found.append(_millilitres("gel", "soft silicone gel", gap_ml(solid), details))
    if area_mm2 := rim_mm2(solid.support):
        details = f"film of {FILM_MM:g} mm between support and base, {area_mm2:.0f} mm2"
        found.append(_millilitres("adhesive", ADHESIVE, area_mm2 * FILM_MM / 1000.0, details))
    return (*found, *housing.bought)


def rim_mm2(support: LabelledSurface) -> float:
    """Area with which a support stands on the base [mm2]: its level faces at its lowest place."""
    corners = support.points_mm[support.faces]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.maximum(np.linalg.norm(normal, axis=1), 1e-300)
    low = corners[:, :, 2].mean(axis=1) < support.points_mm[:, 2].min() + FILM_MM
    flat = low & (normal[:, 2] < -FLAT_COSINE * length)
    return float(length[flat].sum() / 2)


def bolts(moulds: MouldSet) -> tuple[int, float]:
    """How many M3 bolts hold the outer parts together, and what each clamps [mm]; 0 for none."""
    outer = [part for part in moulds.parts if part.name != "core"]
    if len(outer) < 2:
        return 0, 0.0
    if len(outer) > 2:
        return len(outer), 2.0 * GRIP_MM
    return 2, _width_mm(outer)


def bolt_length_mm(clamped_mm: float) -> float | None:
    """The next standard length; None where there is none, and a threaded rod is cut."""
    least_mm = clamped_mm + 2.0 * WASHER_MM + NUT_MM + SPARE_MM
    return next((float(length) for length in LENGTHS_MM if length >= least_mm), None)


def _bolts(moulds: MouldSet) -> list[SupplyItem]:
    count, clamped_mm = bolts(moulds)
    if not count:
        return []
    length_mm = bolt_length_mm(clamped_mm)
    longest_mm = clamped_mm + 2.0 * (WASHER_MM + NUT_MM + SPARE_MM)
    name = f"M3 threaded rod, {np.ceil(longest_mm):g} mm" if length_mm is None else ""
    nuts = 2 * count if length_mm is None else count
    return [
        SupplyItem(
            kind="bolt",
            name=name or f"M3 bolt, {length_mm:g} mm",
            amount=count,
            unit="piece",
            details=f"clamps {clamped_mm:.1f} mm of the mould",
        ),
        SupplyItem(kind="bolt", name="M3 nut", amount=nuts, unit="piece"),
        SupplyItem(kind="bolt", name="M3 washer", amount=2 * count, unit="piece"),
    ]


def _width_mm(outer: list[FabricationPart]) -> float:
    """Width of two parts along the pull of the first."""
    pull = np.array(outer[0].pull)
    return float(np.ptp(np.concatenate([part.points_mm @ pull for part in outer])))


def _area_mm2(surface: LabelledSurface, label: Label) -> float:
    return float(face_areas(surface.points_mm, surface.faces[surface.has(label)]).sum())


def _millilitres(kind: str, name: str, amount: float, details: str) -> SupplyItem:
    return SupplyItem(kind=kind, name=name, amount=round(amount, 3), unit="ml", details=details)
