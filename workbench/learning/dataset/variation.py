"""What differs from case to case besides object, place and way: drawn within a recipe's ranges.

Each case draws by a generator of its own, seeded by the recipe's seed and the case's number, so
that the first N cases of a recipe are the same for every N. All ranges are drawn evenly.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from workbench.core.base.check import within
from workbench.core.base.errors import DesignError

Range = tuple[float, float]
DIGITS = 6
"""Digits kept of what is drawn, so that a case reads the same from its file."""
MOST_LOOKS = 99


@dataclass(frozen=True, kw_only=True, slots=True)
class Looks:
    """Built sensors that a data set is seen by: light and camera of each are off by chance.

    What is off is drawn evenly between minus and plus these amounts: our choice for a sensor that
    is assembled by hand.
    """

    count: int = 0
    """Sensors; 0: only the design's own light and camera."""
    power_share: float = 0.15
    """Of each LED's power [1]."""
    ring_mm: float = 0.3
    """Radius and height of the LED ring, way along it, and each axis of a lamp's place [mm]."""
    camera_mm: float = 0.5
    """Each axis of the camera's place [mm]."""
    camera_deg: float = 1.0
    """Turn of the camera about each axis [degree]."""
    focal_share: float = 0.03
    """Of the focal length [1]."""

    def __post_init__(self) -> None:
        at = "recipe.vary.looks"
        within(self.count, 0, MOST_LOOKS, what="looks", unit="", at=f"{at}.count")
        within(self.power_share, 0.0, 0.9, what="share of power", unit="", at=f"{at}.power_share")
        within(self.ring_mm, 0.0, 5.0, what="error of LEDs", unit="mm", at=f"{at}.ring_mm")
        within(self.camera_mm, 0.0, 5.0, what="error of place", unit="mm", at=f"{at}.camera_mm")
        within(
            self.camera_deg, 0.0, 20.0, what="error of aim", unit="degree", at=f"{at}.camera_deg"
        )
        within(self.focal_share, 0.0, 0.3, what="share of focus", unit="", at=f"{at}.focal_share")


@dataclass(frozen=True, kw_only=True, slots=True)
class Vary:
    """Ranges [least, largest] of a recipe; what is left out is as recipe and design have it."""

    size_mm: Range | None = None
    """Of the object [mm]."""
    spin_deg: Range | None = None
    """Turn of the object about the way of the press, before it [degree]."""
    twist_deg: Range | None = None
    """Turn about the normal after press and shear [degree]."""
    friction: Range | None = None
    """Coefficient of friction [1]."""
    young_MPa: Range | None = None
    """Young's modulus [MPa]."""
    looks: Looks = field(default_factory=Looks)

    def __post_init__(self) -> None:
        limits = (
            ("size_mm", 0.5, 100.0, "mm"),
            ("spin_deg", -180.0, 180.0, "degree"),
            ("twist_deg", -90.0, 90.0, "degree"),
            ("friction", 0.0, 2.0, ""),
            ("young_MPa", 1e-3, 100.0, "MPa"),
        )
        for name, low, high, unit in limits:
            given = getattr(self, name)
            at = f"recipe.vary.{name}"
            for value in given or ():
                what = name.rsplit("_", 1)[0] if unit else name
                within(value, low, high, what=what, unit=unit, at=at)
            if given is not None and given[0] > given[1]:
                raise DesignError(
                    f"the range of {name} goes from {given[0]:g} to {given[1]:g}",
                    hint="give the smaller value first",
                    at=at,
                )


@dataclass(frozen=True, kw_only=True, slots=True)
class Drawn:
    """What a case has drawn; None: as recipe and design have it."""

    size_mm: float | None = None
    spin_deg: float | None = None
    twist_deg: float | None = None
    friction: float | None = None
    young_MPa: float | None = None
    look: int | None = None
    """Which of the built sensors sees it, from 0."""

    @classmethod
    def of_row(cls, row: Mapping[str, Any]) -> Drawn:
        """What the table of a case holds.

        Raises:
            TypeError: If the row has other fields.
        """
        return cls(**row)


NOTHING = Drawn()
"""A case of a recipe that varies nothing."""


def draw(vary: Vary, *, seed: int, number: int) -> Drawn:
    """What case `number` of a recipe draws, the same whatever other ranges are given."""
    rng = np.random.default_rng((seed, number))
    found: dict[str, Any] = {}
    for name in ("size_mm", "spin_deg", "twist_deg", "friction", "young_MPa"):
        share, given = float(rng.random()), getattr(vary, name)
        if given is not None:
            found[name] = round(given[0] + share * (given[1] - given[0]), DIGITS)
    share = float(rng.random())
    if vary.looks.count:
        found["look"] = int(share * vary.looks.count)
    return Drawn(**found)
