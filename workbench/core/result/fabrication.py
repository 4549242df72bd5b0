"""What leaves for the workshop: printable parts, checks of them, the casting recipe.

Sensor frame; mm. Results of the stages `mould`, `housing` and `recipe`.
"""

from __future__ import annotations

import enum
from dataclasses import dataclass

import numpy as np

from workbench.core.base.check import expect


class PartGroup(enum.StrEnum):
    """What a part is for."""

    MOULD = "mould"
    """Shapes the silicone; not in the finished sensor."""
    SENSOR = "sensor"
    """Belongs to the finished sensor."""


class Severity(enum.StrEnum):
    """How a check came out."""

    GOOD = "good"
    WARNING = "warning"
    """It can be made, but somebody should look."""
    BAD = "bad"
    """It cannot be printed, cast or assembled as it is."""


@dataclass(frozen=True, kw_only=True, slots=True)
class FabricationPart:
    """One printable part."""

    name: str
    """File name without ending: letters, digits, underscores."""
    group: PartGroup
    points_mm: np.ndarray
    """Vertices [mm], shape (N, 3), in the assembled position."""
    faces: np.ndarray
    """Triangles, shape (M, 3), int32."""
    brep: np.ndarray
    """OCCT text of the body, shape (bytes,), uint8; empty when only triangles exist."""
    volume_mm3: float
    watertight: bool
    """One closed body after a reload of its STL file."""
    explode: tuple[float, float, float]
    """Where the part stands in the exploded view, from its assembled place [mm]."""
    pull: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """Unit direction in which a mould part leaves the cast; zero for parts of the sensor."""
    process: str = "3D print"
    """How it is made, for the build sheet, for example `print in clear resin, polish`."""

    def __post_init__(self) -> None:
        expect(self.points_mm, "N 3", name="part points")
        expect(self.faces, "M 3", name="part faces")


@dataclass(frozen=True, kw_only=True, slots=True)
class FabricationCheck:
    """One number that decides whether a thing can be made, and where it is worst."""

    name: str
    """Short name in snake case, for example `undercut`."""
    part: str
    """Part looked at, or `cast`."""
    value: float
    unit: str
    limit: float
    sense: str
    """`max`: at most the limit is good; `min`: at least."""
    severity: Severity
    place_mm: tuple[float, float, float]
    """Where it is worst, in the assembled position [mm]."""
    message: str
    """One sentence with value, limit, unit and remedy."""


@dataclass(frozen=True, kw_only=True, slots=True)
class PartMotion:
    """One motion that opens the mould; the others run backward, in reverse order, close it."""

    step: int
    """From 1, in the order in which the parts move."""
    part: str
    direction: tuple[float, float, float]
    """Unit vector in the sensor frame."""
    distance_mm: float
    """Until the part is clear of all that is still in its place [mm]."""
    overlap_mm3: float = 0.0
    """Largest overlap with another rigid part on the way [mm3]; 0 where the way is free."""
    tolerance_mm3: float = 0.0
    """Overlap that is only the rounding of faces that touch [mm3]."""
    overlap_at_mm: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """Where that overlap is [mm]."""
    strain: float = 0.0
    """What the skin must stretch to make way for the part [1]."""
    strain_at_mm: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """Where that is [mm]."""

    @property
    def free(self) -> bool:
        """Whether no rigid part is in the way."""
        return self.overlap_mm3 <= self.tolerance_mm3


@dataclass(frozen=True, kw_only=True, slots=True)
class MouldSet:
    """All parts of a casting mould and what was measured on them."""

    parts: tuple[FabricationPart, ...]
    split_azimuth_deg: float
    """Azimuth of the pull direction of the first outer part [degree]."""
    overlap_mm3: float
    """Largest pairwise overlap of parts, and of parts with the cast body [mm3]."""
    thinnest_wall_mm: float
    cast_volume_mm3: float
    """Silicone in the cavity [mm3], compensated for shrinkage and draft."""
    release_strain: float | None = None
    """Strain of the silicone when the core leaves [1]; None without a core. `Recipe.checks` holds
    it against what the chosen silicone bears."""
    release_mm: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """Where that is [mm]."""
    checks: tuple[FabricationCheck, ...] = ()
    notice: str = ""
    motions: tuple[PartMotion, ...] = ()
    """How the mould is opened, in order."""


@dataclass(frozen=True, kw_only=True, slots=True)
class SupplyItem:
    """Something to buy that is neither silicone, print nor LED."""

    kind: str
    """For example `bolt`."""
    name: str
    amount: float
    unit: str
    """`piece`, `ml` or `mm2`."""
    details: str = ""


@dataclass(frozen=True, kw_only=True, slots=True)
class HousingSet:
    """The rigid parts of the finished sensor, and clearances around LEDs and camera."""

    parts: tuple[FabricationPart, ...]
    checks: tuple[FabricationCheck, ...] = ()
    notice: str = ""
    bought: tuple[SupplyItem, ...] = ()
    """What the parts are made to hold."""


@dataclass(frozen=True, kw_only=True, slots=True)
class LedItem:
    """One LED of the bill of materials."""

    number: int
    colour: str
    """`#rrggbb`."""
    position_mm: tuple[float, float, float]
    axis: tuple[float, float, float]


@dataclass(frozen=True, kw_only=True, slots=True)
class PrintItem:
    """One print of the bill of materials."""

    name: str
    group: PartGroup
    process: str
    volume_mm3: float
    size_mm: tuple[float, float, float]
    """Bounding box [mm]."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Recipe:
    """What to weigh, cast, coat, solder and print."""

    silicone: str
    """Name in the table of silicones."""
    source: str
    """Where its numbers come from."""
    density_g_cm3: float
    cast_ml: float
    """Silicone in the cavity [ml]."""
    pour_ml: float
    """Silicone to mix, waste included [ml]."""
    part_a_g: float
    part_b_g: float
    coating_mm2: float
    """Area of the sensing surface, to be coated [mm2]."""
    leds: tuple[LedItem, ...]
    prints: tuple[PrintItem, ...]
    steps: tuple[str, ...]
    """What to do, in order."""
    checks: tuple[FabricationCheck, ...] = ()
    """What the choice of silicone decides."""
    notice: str = ""
    """For example that no silicone of the table has the design's modulus."""
    supplies: tuple[SupplyItem, ...] = ()
    """What else to have at hand, in the order in which it is needed."""
    size_mm: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """Bounding box of the finished sensor [mm]."""


@dataclass(frozen=True, kw_only=True, slots=True)
class SheetHead:
    """What a build sheet is for."""

    name: str
    """Of the design."""
    family: str
    shrink_percent: float
    """That the cavity is larger by [%]."""
    draft_deg: float
    """Taper of the core [degree]."""
