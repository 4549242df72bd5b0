"""The stage that presses the balls into a twin, as its builder set it up: where it says they were.

Its zero was found by touching the sensor and its axes were laid along the sensor's by eye, so all
places are off alike; and each by what a screw leaves. Source of the amounts: our choice for the
stage of a hobby printer.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from workbench.twin.draw import Draws, stream

ZERO_MM, TURN_DEG = 0.15, 0.5
"""Of its zero along each axis, and of its axes about each of the sensor's, at most."""
EACH_MM = 0.03
"""Standard deviation of one place along each axis [mm]."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Stage:
    """One stage before one sensor."""

    seed: int
    zero_mm: tuple[float, float, float]
    """Where it says the sensor's origin is."""
    turn_deg: tuple[float, float, float]
    """Of its axes, as a rotation vector in the sensor frame."""

    def told_mm(self, place_mm: np.ndarray, number: int) -> np.ndarray:
        """Where it says press `number` was, of a place (3,) in the sensor frame, shape (3,)."""
        from scipy.spatial.transform import Rotation

        # What is read from the store cannot be written to, which SciPy asks for.
        place = np.array(place_mm, dtype=np.float64)
        turned = Rotation.from_rotvec(self.turn_deg, degrees=True).inv().apply(place)
        off_mm = stream(self.seed, Draws.STAGE, 1 + number).normal(0.0, EACH_MM, 3)
        return turned + np.array(self.zero_mm) + off_mm


def draw_stage(seed: int) -> Stage:
    """The stage of the twin of a seed."""
    rng = stream(seed, Draws.STAGE)
    zero, turn = rng.uniform(-ZERO_MM, ZERO_MM, 3), rng.uniform(-TURN_DEG, TURN_DEG, 3)
    (x, y, z), (about_x, about_y, about_z) = np.round(zero, 6).tolist(), np.round(turn, 6).tolist()
    return Stage(seed=seed, zero_mm=(x, y, z), turn_deg=(about_x, about_y, about_z))
