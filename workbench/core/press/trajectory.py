"""A timed path of poses: the rows of a CSV file, arrays of a script, or a function of time.

Times only order the rows and label the frames: contact is quasi-static, so the same poses ten
times as fast give the same forces. Between rows places lie on a straight line and rotations on the
great circle. Row 0 is where the path starts, outside the skin; every later row, or every `every_s`,
is a frame that settles.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from typing import cast

import numpy as np

from workbench.core.base.check import within
from workbench.core.base.errors import DesignError
from workbench.core.base.poses import between

Pose = tuple[float, float, float, float, float, float, float]

AT = "press.trajectory"
COLUMNS = ("t_s", "x_mm", "y_mm", "z_mm", "qw", "qx", "qy", "qz")
FARTHEST_MM = 500.0
"""Largest distance of the object from the sensor's origin along an axis: the edge of the scene."""
MOST_ROWS = 20_000
MOST_FRAMES = 2000
UNIT_ERROR = 0.01
"""Relative error of a quaternion's length that is taken for rounding, and normalised."""


def unit_pose(pose: Iterable[float], *, what: str, at: str = AT) -> Pose:
    """Seven finite numbers with their quaternion normalised.

    Raises:
        DesignError: If a number is not finite, seven are not given, or the quaternion's length is
            more than 1 % off 1.
    """
    numbers = tuple(float(x) for x in pose)
    if len(numbers) != 7:
        raise DesignError(
            f"{what} has {len(numbers)} numbers, a pose has 7",
            hint="give x, y, z in mm, then the unit quaternion qw, qx, qy, qz",
            at=at,
        )
    for name, number in zip(COLUMNS[1:], numbers, strict=True):
        if not math.isfinite(number):
            raise DesignError(
                f"{what}: {name} is {number}, which is not a finite number",
                hint="give every pose as plain numbers",
                at=at,
            )
    length = math.hypot(*numbers[3:])
    if abs(length - 1.0) > UNIT_ERROR:
        raise DesignError(
            f"{what}: the quaternion has length {length:.3f}, not 1",
            hint="give qw, qx, qy, qz of a rotation, scalar first; 1, 0, 0, 0 is no rotation",
            at=at,
        )
    # A length within rounding of 1 stays, so that a file read back gives the same bits.
    scale = 1.0 if abs(length - 1.0) < 1e-14 else length
    return cast("Pose", (*numbers[:3], *(q / scale for q in numbers[3:])))


@dataclass(frozen=True, kw_only=True, slots=True)
class Trajectory:
    """Poses of what moves, by time."""

    times_s: tuple[float, ...]
    """Time of each row, rising [s]."""
    poses: tuple[Pose, ...]
    """x, y, z [mm], qw, qx, qy, qz of each row: of the object's body frame in the sensor frame, or
    of the sensor's frame in the room where the sensor moves."""
    every_s: float = 0.0
    """Time from frame to frame [s]; 0 makes a frame of every row but the first."""
    notice: str = field(default="", compare=False, metadata={"cosmetic": True})
    """What was noticed when it was read."""

    def __post_init__(self) -> None:
        rows = len(self.times_s)
        if rows != len(self.poses):
            raise DesignError(
                f"a trajectory has {rows} times and {len(self.poses)} poses",
                hint="give one time to each pose",
                at=AT,
            )
        hint = "the first row is where the path starts, each further one is a frame"
        within(rows, 2, MOST_ROWS, what="row count of the trajectory", unit="", at=AT, hint=hint)
        for row, time_s in enumerate(self.times_s):
            if not math.isfinite(time_s):
                raise DesignError(
                    f"row {row + 1}: t_s is {time_s}, which is not a finite number",
                    hint="give the time of each row in seconds",
                    at=AT,
                )
        for row, (before_s, time_s) in enumerate(itertools.pairwise(self.times_s)):
            if time_s <= before_s:
                raise DesignError(
                    f"row {row + 2}: t_s {time_s:g} s does not come after {before_s:g} s of row "
                    f"{row + 1}",
                    hint="sort the rows by time and give each time once",
                    at=AT,
                )
        unit = [unit_pose(pose, what=f"row {row + 1}") for row, pose in enumerate(self.poses)]
        object.__setattr__(self, "times_s", tuple(float(t) for t in self.times_s))
        object.__setattr__(self, "poses", tuple(unit))
        if self.every_s != 0.0:
            least_s = self.duration_s / MOST_FRAMES
            what, hint = "time between frames", "0 makes a frame of every row"
            within(self.every_s, least_s, self.duration_s, what=what, unit="s", at=AT, hint=hint)
        elif rows > MOST_FRAMES + 1:
            raise DesignError(
                f"the trajectory has {rows} rows, each a frame; the limit is {MOST_FRAMES} frames",
                hint=f"set the time between frames, for example {self.duration_s / 100:.3g} s",
                at=AT,
            )

    @classmethod
    def from_arrays(
        cls, times_s: np.ndarray, poses: np.ndarray, *, every_s: float = 0.0
    ) -> Trajectory:
        """From times, shape (K,), and poses, shape (K, 7)."""
        times = tuple(float(time_s) for time_s in np.asarray(times_s).reshape(-1))
        rows = [unit_pose(pose, what=f"row {row + 1}") for row, pose in enumerate(poses)]
        return cls(times_s=times, poses=tuple(rows), every_s=every_s)

    @classmethod
    def from_function(
        cls,
        function: Callable[[float], Iterable[float]],
        times_s: Iterable[float],
        *,
        every_s: float = 0.0,
    ) -> Trajectory:
        """From a function of time [s] to x, y, z [mm], qw, qx, qy, qz, taken at `times_s`."""
        times = np.array([float(time_s) for time_s in times_s])
        rows = [tuple(function(float(time_s))) for time_s in times]
        return cls.from_arrays(times, cast("np.ndarray", rows), every_s=every_s)

    @property
    def duration_s(self) -> float:
        """Time from the first to the last row [s]."""
        return self.times_s[-1] - self.times_s[0]

    @property
    def frame_count(self) -> int:
        """Frames that settle; the start is none."""
        if self.every_s == 0.0:
            return len(self.times_s) - 1
        # A last frame that is a rounding error long is none.
        return max(1, math.ceil(self.duration_s / self.every_s - 1e-6))

    def frame_times_s(self) -> np.ndarray:
        """Time of the start and of every frame [s], shape (frame_count + 1,)."""
        if self.every_s == 0.0:
            return np.array(self.times_s)
        count = self.frame_count
        return np.append(self.times_s[0] + self.every_s * np.arange(count), self.times_s[-1])

    def at_progress(self, progress: np.ndarray) -> np.ndarray:
        """Poses after so many frames, shape (P,), in between by time; shape (P, 7)."""
        labels_s = self.frame_times_s()
        times_s = np.interp(progress, np.arange(len(labels_s)), labels_s)
        return poses_at(np.array(self.times_s), np.array(self.poses), times_s)


def poses_at(known_s: np.ndarray, rows: np.ndarray, times_s: np.ndarray) -> np.ndarray:
    """Poses at times [s], shape (P,), held before the first row and after the last; (P, 7).

    Args:
        known_s: Rising time of each row [s], shape (R,).
        rows: Poses, shape (R, 7).
        times_s: When.
    """
    times = np.clip(times_s, known_s[0], known_s[-1])
    row = np.clip(np.searchsorted(known_s, times, side="right") - 1, 0, len(known_s) - 2)
    shares = (times - known_s[row]) / (known_s[row + 1] - known_s[row])
    return between(rows[row], rows[row + 1], shares)
