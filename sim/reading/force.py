"""The force that a read touch needs, by the law of the wall below it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim.reading.layer_law import Layer, influence_mm_per_MPa, pressure_MPa

MOST_PLACES = 700
"""Vertices under pressure, of which the deepest are taken: beyond them every second would do."""
LAW_ERROR = 0.15
"""Relative standard deviation of the law against presses of the contact solver."""


@dataclass(frozen=True, kw_only=True, slots=True)
class ReadForce:
    """On the membrane, in the sensor frame."""

    force_N: np.ndarray
    """Shape (3,)."""
    sigma_N: float
    """Standard deviation of its size."""


def read_force(
    layer: Layer,
    places_mm: np.ndarray,
    inward: np.ndarray,
    area_mm2: np.ndarray,
    depths_mm: tuple[np.ndarray, np.ndarray],
) -> ReadForce:
    """Force of a touch.

    Args:
        layer: The wall under it.
        places_mm: Touched vertices at rest, shape (n, 3).
        inward: Their unit normals into the sensor, shape (n, 3).
        area_mm2: Area that each stands for, shape (n,).
        depths_mm: Their inward displacement and its standard deviation, shape (n,) each.
    """
    inward_mm, sigma_mm = depths_mm
    if not len(inward_mm):
        return ReadForce(force_N=np.zeros(3), sigma_N=0.0)
    kept = np.argsort(inward_mm)[::-1][:MOST_PLACES]
    influence = influence_mm_per_MPa(layer, places_mm[kept], area_mm2[kept])

    def total(moved_mm: np.ndarray) -> np.ndarray:
        return (pressure_MPa(influence, moved_mm[kept]) * area_mm2[kept]) @ inward[kept]

    force_N = total(inward_mm)
    size_N = float(np.linalg.norm(force_N))
    deeper_N = float(np.linalg.norm(total(inward_mm + np.nan_to_num(sigma_mm))))
    return ReadForce(
        force_N=force_N, sigma_N=float(np.hypot(LAW_ERROR * size_N, deeper_N - size_N))
    )
