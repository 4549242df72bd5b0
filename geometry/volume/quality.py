"""How good a mesh is, as numbers and histograms: scaled Jacobian, edges, angles, volume.

Scaled Jacobian of a tetrahedron: sqrt 2 times its six-fold volume over the largest product of the
three edges at a corner (Verdict library manual, SAND2007-1751); 1 is regular, 0 flat. Angles are
those of triangles in the skins. Leaves out: skewness, aspect ratio.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from workbench.core.result.quality import MeshQuality, QualityReport
from workbench.core.result.results import MembraneMesh, Skin, VolumeMesh

BINS = 20
PERCENT = (0.0, 1.0, 5.0, 50.0, 95.0, 100.0)
TET_EDGES = ((0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3))
CELL_EDGES = {
    3: ((0, 1), (1, 2), (2, 0)),
    4: TET_EDGES,
    8: (
        *((0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4)),
        *((0, 4), (1, 5), (2, 6), (3, 7)),
    ),
}
"""Pairs of corners in VTK order by number of corners."""


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Measure:
    """What cells are judged by."""

    values: np.ndarray
    """Of each cell, larger is better, shape (M,)."""
    low: float
    """Where its histogram begins."""
    high: float
    """Where it ends."""


def quality_report(mesh: MembraneMesh, volume_mm3: float) -> QualityReport:
    """Quality of the hexahedra, if any, and of both skins.

    Args:
        mesh: Meshes of one body.
        volume_mm3: Volume of the elastomer by the CAD kernel.
    """
    return QualityReport(
        volume=None if mesh.hexes is None else volume_quality(mesh.hexes, volume_mm3),
        outer=skin_quality(mesh.outer),
        inner=skin_quality(mesh.inner),
        notice=mesh.notice,
    )


def volume_quality(mesh: VolumeMesh, volume_mm3: float) -> MeshQuality:
    """Quality of hexahedra or tetrahedra; cells are judged by their scaled Jacobian."""
    pairs = np.array(CELL_EDGES[mesh.cells.shape[1]])
    ends = np.sort(mesh.cells[:, pairs].reshape(-1, 2).astype(np.int64), axis=1)
    span = len(mesh.points_mm)
    both = np.unique(ends[:, 0] * span + ends[:, 1])
    length_mm = np.linalg.norm(mesh.points_mm[both // span] - mesh.points_mm[both % span], axis=1)
    return _judged(
        mesh.points_mm,
        mesh.cells,
        Measure(
            values=mesh.quality.astype(np.float64),
            low=min(0.0, float(mesh.quality.min())),
            high=1.0,
        ),
        length_mm,
        volume_ratio=mesh.volume_mm3 / volume_mm3,
    )


def skin_quality(skin: Skin) -> MeshQuality:
    """Quality of a skin; triangles are judged by their smallest angle in degrees."""
    corners = skin.points_mm[skin.faces]
    edges = np.roll(corners, -1, axis=1) - corners
    length_mm = np.linalg.norm(edges, axis=2)
    unit = edges / np.maximum(length_mm, 1e-300)[:, :, None]
    cosine = -np.einsum("fij,fij->fi", unit, np.roll(unit, 1, axis=1))
    angle_deg = np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0))).min(axis=1)
    measure = Measure(values=angle_deg, low=0.0, high=60.0)
    return _judged(skin.points_mm, skin.faces, measure, length_mm.ravel())


def tetrahedron_quality(points_mm: np.ndarray, cells: np.ndarray) -> np.ndarray:
    """Scaled Jacobian of tetrahedra (M, 4) in VTK order, shape (M,)."""
    a, b, c, d = (points_mm[column] for column in cells.T)
    length = {
        pair: np.linalg.norm(points_mm[cells[:, pair[0]]] - points_mm[cells[:, pair[1]]], axis=1)
        for pair in TET_EDGES
    }
    largest = np.maximum.reduce(
        [
            length[0, 1] * length[0, 2] * length[0, 3],
            length[0, 1] * length[1, 2] * length[1, 3],
            length[0, 2] * length[1, 2] * length[2, 3],
            length[0, 3] * length[1, 3] * length[2, 3],
        ]
    )
    six_volumes = np.einsum("ij,ij->i", np.cross(b - a, c - a), d - a)
    return np.sqrt(2.0) * six_volumes / np.maximum(largest, 1e-300)


def _judged(
    points_mm: np.ndarray,
    cells: np.ndarray,
    measure: Measure,
    length_mm: np.ndarray,
    *,
    volume_ratio: float = float("nan"),
) -> MeshQuality:
    values, low, high = measure.values, measure.low, measure.high
    worst = int(values.argmin())
    counts, borders = np.histogram(np.clip(values, low, high), bins=BINS, range=(low, high))
    edge_counts, edge_borders = np.histogram(length_mm, bins=BINS)
    return MeshQuality(
        cells=len(cells),
        nodes=len(points_mm),
        measure=np.percentile(values, PERCENT),
        measure_counts=counts,
        measure_borders=borders,
        edge_mm=np.percentile(length_mm, PERCENT),
        edge_counts=edge_counts,
        edge_borders_mm=edge_borders,
        worst=worst,
        worst_mm=points_mm[cells[worst]],
        volume_ratio=volume_ratio,
    )
