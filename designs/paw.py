"""Paw: a cat's paw, four toe pads and one large pad standing proud on a lobed body.

           _   _   _   _          seen from above: toes toward +Y
          ( ) ( ) ( ) ( )
           `-. `---' .-'
          |   .-----.   |         the large (metacarpal) pad
           `. (_____) .'
             `-.___.-'

            .-. ___ .-.           z = height_mm + pad_mm, tops of the pads
          _/   `   `   \\_         z = height_mm, the flat top of the body
         |  ___________  |        outside in: elastomer, support (rigid, clear), cavity
         | |           | |
     ____|_|___________|_|____    z = 0, base plane
    |         | cam |         |
    |_________|_____|_________|   z = -base_height_mm, the rigid foot

| parameter        | meaning                                                       |
|------------------|---------------------------------------------------------------|
| `radius_mm`      | radius of the body between its toes                           |
| `height_mm`      | height of the flat top over the base                          |
| `toe_mm`         | how far the toes bulge out of the round body                  |
| `toe_spread_deg` | angle from the first toe to the fourth                        |
| `pad_mm`         | how far the pads stand out of the top                         |
| `toe_pad_mm`     | radius of a toe pad where it leaves the top                   |
| `large_pad_mm`   | half width of the large pad there                             |
| `rim_mm`         | radius of the rounded top rim                                 |
| `base_height_mm` | height of the foot                                            |
| `base_lip_mm`    | how far the foot stands out beyond the skin                   |

The outline bulges smoothly at each toe (`designs/lobed_outline.py`). The core's outline is less by
the wall along the normal, its top flat. Pads are spheres through the top, the large one a sphere
drawn out along X (`designs/paw_pads.py`): their volume is a closed form.

Source of the defaults: our choice, after pictures of a cat's paw. Leaves out: claws, the dewclaw,
the notch of the large pad, screw holes in the foot.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from designs import distance
from designs.bodies import Bodies, Fields
from designs.lobed_outline import LobedOutline
from designs.paw_pads import BETWEEN_MM, Pads, check_pads, expect_pads, pad_bodies, pads_field
from designs.prisms import Outline, elliptic_foot, rounded_prism
from designs.shells import hollow
from designs.sliders import slider
from workbench.core.base.booleans import expect_volume, fuse, volume
from workbench.core.base.errors import DesignError
from workbench.core.design.design import Layers
from workbench.core.result.marks import Field

TOES = 4
CAVITY_MM = 3.0
"""Smallest half width and height of the cavity: room for camera and LEDs [mm]."""
LARGE_STRETCH = 0.5
"""Half the straight part of the large pad along X, over its half width along Y."""
LARGE_PLACE = -0.27
"""Place of the large pad on Y, over the radius of the body."""
PAD_LIMIT = 1e-3
"""Tolerance of the body's volume with pads; the kernel integrates trimmed faces to 2e-4."""
CORE_RIM_SHARE = 0.4
"""Most of a core's narrowest bend that its rim radius may take; the body's own never is narrower
than 3 mm, and its rim at most 2.5 mm."""


@dataclass(frozen=True, kw_only=True, slots=True)
class PawShape:
    """The paw's own parameters."""

    radius_mm: float = slider(
        15.0, (11.0, 26.0, 0.5), "mm", "Radius", "Radius of the body between its toes"
    )
    height_mm: float = slider(
        24.0, (14.0, 50.0, 0.5), "mm", "Height", "From the base to the flat top"
    )
    toe_mm: float = slider(
        2.0, (0.5, 3.0, 0.1), "mm", "Toe bulge", "How far the toes stand out of the round body"
    )
    toe_spread_deg: float = slider(
        135.0, (120.0, 160.0, 1.0), "degree", "Toe spread", "From the first toe to the fourth"
    )
    pad_mm: float = slider(
        2.0, (0.5, 4.0, 0.1), "mm", "Pad height", "How far the pads stand out of the top"
    )
    toe_pad_mm: float = slider(
        3.0, (1.5, 5.0, 0.1), "mm", "Toe pad radius", "Of a toe pad where it leaves the top"
    )
    large_pad_mm: float = slider(
        4.5, (2.5, 8.0, 0.1), "mm", "Large pad", "Half width of the large pad along Y"
    )
    rim_mm: float = slider(
        1.5, (0.5, 2.5, 0.1), "mm", "Rim radius", "Rounding of the top rim and of the core's"
    )
    base_height_mm: float = slider(
        8.0, (2.0, 40.0, 0.5), "mm", "Foot height", "Rigid foot that carries camera and LEDs"
    )
    base_lip_mm: float = slider(
        2.0, (0.0, 15.0, 0.5), "mm", "Foot lip", "How far the foot stands out beyond the toes"
    )

    @property
    def toes_rad(self) -> np.ndarray:
        """Azimuth of each toe [rad], symmetric about +Y."""
        half = math.radians(self.toe_spread_deg) / 2
        return np.pi / 2 + np.linspace(-half, half, TOES)

    @property
    def pads(self) -> Pads:
        """The pads on the top."""
        return Pads(
            toe_places_mm=self.toe_places_mm,
            toe_mm=self.toe_pad_mm,
            large_ends_mm=self.large_ends_mm,
            large_mm=self.large_pad_mm,
            rise_mm=self.pad_mm,
            top_mm=self.height_mm,
        )

    @property
    def large_ends_mm(self) -> np.ndarray:
        """Ends of the large pad's middle line [mm], shape (2, 2)."""
        x_mm, y_mm = LARGE_STRETCH * self.large_pad_mm, LARGE_PLACE * self.radius_mm
        return np.array([[-x_mm, y_mm], [x_mm, y_mm]])

    @property
    def toe_places_mm(self) -> np.ndarray:
        """Middle of each toe pad [mm], shape (4, 2): as far out as the rim lets it."""
        turn = self.toes_rad
        reach = self.outline(0.0).radius(turn) - self.rim_mm - BETWEEN_MM - self.toe_pad_mm
        return reach[:, None] * np.column_stack([np.cos(turn), np.sin(turn)])

    def outline(self, inset_mm: float) -> LobedOutline:
        """The body's outline less by an inset."""
        return LobedOutline(
            radius_mm=self.radius_mm,
            bulge_mm=self.toe_mm,
            bulges_rad=self.toes_rad,
            inset_mm=inset_mm,
        )


@dataclass(frozen=True, kw_only=True, slots=True)
class Paw:
    """Builds paws."""

    name: str = "paw"
    title: str = "Cat's paw"
    shape_type: type = PawShape

    def check(self, shape: PawShape, layers: Layers) -> None:
        """Refuse pads that meet, and walls that leave no room.

        Raises:
            DesignError: Naming the field, its value and its limit.
        """
        both_mm = layers.elastomer_mm + layers.support_mm
        room_mm = min(shape.outline(both_mm).least_mm, shape.height_mm - both_mm)
        if room_mm < CAVITY_MM:
            raise DesignError(
                f"support and elastomer wall together {both_mm:g} mm leave {room_mm:.3g} mm of "
                f"cavity, less than {CAVITY_MM:g} mm",
                hint="lower layers.elastomer_mm or layers.support_mm, or raise shape.radius_mm or "
                "shape.height_mm",
                at="layers.elastomer_mm",
            )
        check_pads(shape.pads, shape.outline(0.0).points_mm, shape.rim_mm)

    def soften(self, shape: PawShape) -> PawShape:
        """The paw with half the rim radius."""
        return replace(shape, rim_mm=shape.rim_mm / 2)

    def target(self, shape: PawShape, layers: Layers) -> tuple[float, float, float]:
        """The middle of the large pad."""
        return 0.0, float(shape.large_ends_mm[0, 1]), shape.height_mm + shape.pad_mm

    def build(self, shape: PawShape, layers: Layers) -> Bodies:
        """Build the five bodies.

        Raises:
            DesignError: As `check`.
            GeometryError: If the CAD kernel returned something else than asked for, or a pad is
                missing.
        """
        self.check(shape, layers)
        both_mm, pads = layers.elastomer_mm + layers.support_mm, shape.pads
        outer = _prism(shape, 0.0, what="body")
        expected_mm3 = volume(outer) + pads.volume_mm3
        outer = fuse(outer, pad_bodies(pads), what="pads")
        expect_volume(outer, expected_mm3, what="pads", relative=PAD_LIMIT)
        expect_pads(outer, pads)
        core = _prism(shape, layers.elastomer_mm, what="core")
        return Bodies(
            membrane=hollow(outer, core, what="elastomer"),
            outer=outer,
            core=core,
            support=hollow(core, _prism(shape, both_mm, what="cavity"), what="support"),
            base=_foot(shape, layers),
        )

    def fields(self, shape: PawShape, layers: Layers) -> Fields:
        """Lobed prisms and spheres as signed distance fields."""
        self.check(shape, layers)
        body, pads = _prism_field(shape, 0.0), pads_field(shape.pads)

        def outer(points_mm: np.ndarray) -> np.ndarray:
            return np.minimum(body(points_mm), pads(points_mm))

        outline_mm = shape.outline(0.0).points_mm
        low, high = outline_mm.min(axis=0), outline_mm.max(axis=0)
        return Fields(
            outer=outer,
            core=_prism_field(shape, layers.elastomer_mm),
            cavity=_prism_field(shape, layers.elastomer_mm + layers.support_mm),
            base=_foot(shape, layers),
            wall_mm=layers.elastomer_mm,
            low_mm=(float(low[0]), float(low[1]), 0.0),
            high_mm=(float(high[0]), float(high[1]), shape.height_mm + shape.pad_mm),
        )


def _rim_mm(shape: PawShape, outline: LobedOutline) -> float:
    """Rim radius of a core: the body's, as far as its bends allow."""
    return min(shape.rim_mm, CORE_RIM_SHARE * outline.bend_mm)


def _prism(shape: PawShape, inset_mm: float, *, what: str) -> Any:
    outline = shape.outline(inset_mm)
    return rounded_prism(
        Outline(
            edges=outline.edges(),
            area_mm2=outline.area_mm2,
            perimeter_mm=outline.perimeter_mm,
        ),
        top_mm=shape.height_mm - inset_mm,
        rim_mm=_rim_mm(shape, outline) if inset_mm else shape.rim_mm,
        what=what,
    )


def _prism_field(shape: PawShape, inset_mm: float) -> Field:
    outline = shape.outline(inset_mm)
    rim_mm = _rim_mm(shape, outline) if inset_mm else shape.rim_mm
    top_mm = shape.height_mm - inset_mm

    def inside(points_mm: np.ndarray) -> np.ndarray:
        above = points_mm[:, 2] - top_mm
        return distance.rounded_both(outline.distance(points_mm), above, rim_mm)

    return inside


def _foot(shape: PawShape, layers: Layers) -> Any:
    radius_mm = shape.outline(0.0).greatest_mm
    cavity_mm = shape.radius_mm - layers.elastomer_mm - layers.support_mm
    half = radius_mm, radius_mm
    return elliptic_foot(half, cavity_mm, shape.base_height_mm, shape.base_lip_mm)


FAMILY = Paw()
