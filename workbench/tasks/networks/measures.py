"""Measures of a dent that was read, for a head that learns: how deep, wide, full and steep it is.

What presses the skin leaves its pressure in the dent: deep where it pushes far, steep where it has
edges, wide where it is blunt. A sensor in another light that is known reads nearly the same dent,
so what is learned from renders holds on photographs.
"""

from __future__ import annotations

import numpy as np

from workbench.tasks.networks.patch import GREY_PER_MM, MM_PER_PX

TOP, STEEPEST = (5, 50, 200), 20
"""Pixels that the deepest of a dent are means of, and the steepest."""
LEVELS_MM, SHARES = (0.05, 0.1), (0.5, 0.8)
"""Depths, and shares of the deepest, beyond which its area counts."""
COUNT = 14
LEAST_MM2 = 1.0
"""Added to the area that a volume is divided by: of no dent the mean depth is none."""


def measures(inputs: np.ndarray) -> np.ndarray:
    """Measures of dents, shape (N, 1, T, `COUNT`), float32.

    Args:
        inputs: As `DentSight` reads them and `SkinSight` lays them flat, `GREY_PER_MM` for a
            millimetre, shape (N, T, h, w, 3), int16.
    """
    rows = [[_of_one(image[..., 0] / GREY_PER_MM) for image in each] for each in inputs]
    return np.array(rows, np.float32)[:, None]


def _of_one(inward_mm: np.ndarray) -> list[float]:
    """Of a dent (h, w) [mm]: lengths in mm, areas in mm2, slopes in mm per mm."""
    dent_mm = np.maximum(inward_mm, 0.0)
    pixel_mm2 = MM_PER_PX**2
    down, across = np.gradient(dent_mm, MM_PER_PX)
    slope = np.hypot(across, down)
    deepest, deep, wide = (_top(dent_mm, count) for count in TOP)
    steep, volume_mm3 = _top(slope, STEEPEST), float(dent_mm.sum()) * pixel_mm2
    levels_mm = (*LEVELS_MM, *(share * deepest + 1e-9 for share in SHARES))
    areas_mm2 = [float((dent_mm > level).sum()) * pixel_mm2 for level in levels_mm]
    return [
        *(deepest, deepest**1.5, deepest**2, deep, wide),
        *areas_mm2,
        *(volume_mm3, volume_mm3 / (areas_mm2[0] + LEAST_MM2)),
        *(steep, deepest * steep, float((slope**2).sum()) * pixel_mm2),
    ]


def _top(values: np.ndarray, count: int) -> float:
    """Mean of the largest."""
    return float(np.partition(values.ravel(), -count)[-count:].mean())
