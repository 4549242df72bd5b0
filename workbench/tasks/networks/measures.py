"""Measures of a dent that was read, for a head that learns pressures.

What presses the skin leaves its pressure in the dent. What an elastic layer would have under it
tells most of that, in any light and of any object. A large or sharp object that presses deep is
read too shallow and told too soft; how deep, wide, full and steep its dent is tells by how much.
A sensor in another light that is known reads nearly the same dent, so what is learned from renders
holds on photographs.

Each is told as it is and as its logarithm: what changes a pressure multiplies it.
"""

from __future__ import annotations

import numpy as np

from sim.forces.peaks import DISC_MM
from workbench.tasks.networks.layer_pressure import disc_pressure
from workbench.tasks.networks.patch import DENT, GREY_PER_MM, MM_PER_PX

TOP, STEEPEST = (5, 50, 200), 20
"""Pixels that the deepest of a dent are means of, and the steepest."""
LEVELS_MM, SHARES = (0.05, 0.1), (0.5, 0.8)
"""Depths, and shares of the deepest, beyond which its area counts."""
LEAST = np.array([1e-3, *[0.01] * 3, *[0.1] * 4, 0.1, 0.01, 0.1])
"""Added to each before its logarithm: of no dent it is finite."""
COUNT = 2 * len(LEAST)
PRESSURE = 0
"""Which is the logarithm of the pressure over E*."""


def measures(inputs: np.ndarray) -> np.ndarray:
    """Measures of dents, logarithms before the rest, shape (N, 1, T, `COUNT`), float32.

    Args:
        inputs: As `DentSight` reads them and `SkinSight` lays them flat, `GREY_PER_MM` for a
            millimetre, shape (N, T, h, w, 3), int16.
    """
    rows = [[_of_one(image[..., DENT] / GREY_PER_MM) for image in each] for each in inputs]
    found = np.array(rows)
    return np.concatenate([np.log(found + LEAST), found], axis=2, dtype=np.float32)[:, None]


def _of_one(inward_mm: np.ndarray) -> list[float]:
    """Of a dent (h, w) [mm]: pressure over E*, lengths [mm], areas [mm2], volume [mm3], slopes."""
    dent_mm = np.maximum(inward_mm, 0.0)
    pixel_mm2 = MM_PER_PX**2
    down, across = np.gradient(dent_mm, MM_PER_PX)
    slope = np.hypot(across, down)
    deepest, deep, wide = (_top(dent_mm, count) for count in TOP)
    levels_mm = (*LEVELS_MM, *(share * deepest + 1e-9 for share in SHARES))
    return [
        max(float(disc_pressure(dent_mm, DISC_MM).max()), 0.0),
        *(deepest, deep, wide),
        *(float((dent_mm > level).sum()) * pixel_mm2 for level in levels_mm),
        float(dent_mm.sum()) * pixel_mm2,
        _top(slope, STEEPEST),
        float((slope**2).sum()) * pixel_mm2,
    ]


def _top(values: np.ndarray, count: int) -> float:
    """Mean of the largest."""
    return float(np.partition(values.ravel(), -count)[-count:].mean())
