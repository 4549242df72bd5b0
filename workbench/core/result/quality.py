"""How good the cells of a body's meshes are, as the stage `quality` returns it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, kw_only=True, slots=True)
class MeshQuality:
    """How good the cells of one mesh are.

    Percentiles are 0, 1, 5, 50, 95 and 100 %. The measure is the scaled Jacobian of hexahedra and
    tetrahedra, the smallest angle in degrees of triangles.
    """

    cells: int
    nodes: int
    measure: np.ndarray
    """Percentiles of the measure, shape (6,); the first is the worst cell's."""
    measure_counts: np.ndarray
    """Cells in each bin of the measure, shape (B,), int64."""
    measure_borders: np.ndarray
    """Borders of those bins, shape (B + 1,)."""
    edge_mm: np.ndarray
    """Percentiles of edge length [mm], shape (6,)."""
    edge_counts: np.ndarray
    """Edges in each bin of length, shape (B,), int64."""
    edge_borders_mm: np.ndarray
    """Borders of those bins [mm], shape (B + 1,)."""
    worst: int
    """Number of the worst cell."""
    worst_mm: np.ndarray
    """Its corners in VTK order [mm], shape (8, 3), (4, 3) or (3, 3)."""
    volume_ratio: float = float("nan")
    """Volume of all cells over that of the CAD kernel; NaN for skins."""


@dataclass(frozen=True, kw_only=True, slots=True)
class QualityReport:
    """Quality of all meshes of a body."""

    volume: MeshQuality | None
    """Hexahedra; None where there are none."""
    outer: MeshQuality
    inner: MeshQuality
    notice: str = ""
    """Why there are no hexahedra."""
