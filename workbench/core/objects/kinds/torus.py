"""Lies flat: outer diameter `size_mm`, tube diameter 0.3 `size_mm`."""

from __future__ import annotations

import numpy as np

from workbench.core.objects.kind import Distance, Group, Kind

TUBE_SHARE = 0.15
"""Radius of the tube over the outer diameter."""


def distance(size_mm: float, edge_mm: float) -> Distance:
    """It has no edges to round."""
    tube = TUBE_SHARE * size_mm

    def to_torus(place: np.ndarray) -> np.ndarray:
        rho = np.hypot(place[:, 0], place[:, 1])
        return np.hypot(rho - (0.5 * size_mm - tube), place[:, 2]) - tube

    return to_torus


def tube_mm(size_mm: float, edge_mm: float) -> float:
    """Radius of the tube."""
    return TUBE_SHARE * size_mm


KIND = Kind(
    place=16,
    group=Group.OTHER,
    edge_share=None,
    distance=distance,
    half_extent_mm=lambda size_mm: size_mm * np.array([0.5, 0.5, TUBE_SHARE]),
    lowest_mm=tube_mm,
    sharpest_mm=tube_mm,
)
