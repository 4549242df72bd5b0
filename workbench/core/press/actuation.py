"""Actuators: parts of the membrane that are driven along a prescribed motion."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

import numpy as np

from workbench.core.base.check import within
from workbench.core.base.errors import DesignError

Key = tuple[float, float]
Place = tuple[float, float, float]


@dataclass(frozen=True, kw_only=True, slots=True)
class Actuation:
    """A rigid motion of one region: first the turn about an axis, then the shift, both in shares.

    The share of the motion that is done follows `keys`, linear in between, constant beyond.
    """

    region: str = "actuator_0"
    """Region that moves: a name from `region_masks`, for example `actuator_0` or `inner`."""
    move_mm: Place = (0.0, 0.0, 0.0)
    """Whole shift [mm], sensor frame."""
    turn_deg: float = 0.0
    """Whole turn about the axis, right-handed [degree]."""
    axis: Place = (1.0, 0.0, 0.0)
    """Direction of the axis."""
    about_mm: Place = (0.0, 0.0, 0.0)
    """A point of the axis [mm]."""
    facing: Place = (0.0, 0.0, 0.0)
    """Only faces whose outward normal has a part along this direction move; zero: all of them."""
    keys: tuple[Key, ...] = ((0.0, 0.0), (10.0, 1.0))
    """(frame, share) pairs in the order of frames; frame 0 is before the first frame."""

    def __post_init__(self) -> None:
        numbers = (
            *self.move_mm,
            *self.axis,
            *self.about_mm,
            *(x for key in self.keys for x in key),
        )
        if not all(math.isfinite(x) for x in numbers):
            raise DesignError(
                f"the actuation of {self.region} holds a number that is not finite",
                hint="give move_mm, axis, about_mm and keys as plain numbers",
                at="press.actuations",
            )
        at = "press.actuations"
        for shift_mm in self.move_mm:
            within(shift_mm, -50.0, 50.0, what="actuator shift", unit="mm", at=at)
        within(self.turn_deg, -90.0, 90.0, what="actuator turn", unit="degree", at=at)
        if not any(self.axis):
            raise DesignError(
                "the axis of an actuation has no direction",
                hint="(1, 0, 0) turns about X",
                at=at,
            )
        frames = [frame for frame, _ in self.keys]
        if not frames or frames[0] < 0.0 or any(a >= b for a, b in itertools.pairwise(frames)):
            raise DesignError(
                f"the frames {tuple(frames)} of an actuation do not rise from 0",
                hint="for example keys ((0, 0), (10, 1)): all of the motion within ten frames",
                at=at,
            )
        if any(frame != round(frame) for frame in frames):
            raise DesignError(
                f"the frames {tuple(frames)} of an actuation are not whole",
                hint="a frame goes straight from its start to its end: put keys at whole frames",
                at=at,
            )
        for _, share in self.keys:
            within(share, -1.0, 1.0, what="share of an actuation", unit="", at=at)

    @property
    def last_frame(self) -> int:
        """Frame at which the motion has ended."""
        return math.ceil(self.keys[-1][0])

    def share(self, progress: float) -> float:
        """Share of the motion that is done after `progress` frames."""
        frames, shares = zip(*self.keys, strict=True)
        return float(np.interp(progress, frames, shares))

    def displacement_mm(self, places_mm: np.ndarray, progress: float) -> np.ndarray:
        """Displacement of undeformed places, (N, 3), after `progress` frames [mm], (N, 3).

        The turn is Rodrigues' rotation.
        """
        share = self.share(progress)
        angle = math.radians(share * self.turn_deg)
        axis = np.asarray(self.axis) / np.linalg.norm(self.axis)
        arm = places_mm - np.asarray(self.about_mm)
        across = np.cross(axis, arm)
        along = (arm @ axis)[:, None] * axis
        turned = math.cos(angle) * (arm - along) + math.sin(angle) * across + along
        return turned - arm + share * np.asarray(self.move_mm)
