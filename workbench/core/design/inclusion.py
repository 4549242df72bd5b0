"""Parts of the membrane that are made of another elastomer."""

from __future__ import annotations

import enum
import math
from dataclasses import dataclass

from workbench.core.base.check import within
from workbench.core.base.errors import DesignError

Place = tuple[float, float, float]

SOFTEST_MPa, STIFFEST_MPa = 1e-4, 1e3
LARGEST_POISSON = 0.495


class Where(enum.StrEnum):
    """How the part is bounded."""

    COAT = "coat"
    """All within `depth_mm` of the outer skin."""
    BALL = "ball"
    """All within `radius_mm` of `centre_mm`."""
    BOX = "box"
    """The box of `size_mm` about `centre_mm`, along the axes of the sensor."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Inclusion:
    """A part of the membrane with its own constants; where two overlap the later one counts."""

    where: Where = Where.COAT
    young_MPa: float = 0.5
    """Young's modulus [MPa]."""
    poisson: float = 0.45
    depth_mm: float = 0.5
    """Thickness of a coat [mm]."""
    radius_mm: float = 3.0
    """Of a ball [mm]."""
    centre_mm: Place = (0.0, 0.0, 0.0)
    """Of a ball or a box [mm], sensor frame."""
    size_mm: Place = (6.0, 6.0, 6.0)
    """Of a box [mm]."""

    def __post_init__(self) -> None:
        at = "material.inclusions"
        low, high = SOFTEST_MPa, STIFFEST_MPa
        within(self.young_MPa, low, high, what="Young's modulus", unit="MPa", at=at)
        within(self.poisson, 0.0, LARGEST_POISSON, what="Poisson's ratio", unit="", at=at)
        within(self.depth_mm, 0.05, 50.0, what="coat thickness", unit="mm", at=at)
        within(self.radius_mm, 0.1, 200.0, what="radius of the inclusion", unit="mm", at=at)
        for edge_mm in self.size_mm:
            within(edge_mm, 0.1, 400.0, what="edge of the inclusion", unit="mm", at=at)
        if not all(math.isfinite(x) for x in self.centre_mm):
            raise DesignError(
                f"the centre {self.centre_mm} of an inclusion is not finite",
                hint="give x, y, z in mm from the centre of the base",
                at=at,
            )
