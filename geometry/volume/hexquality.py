"""Volume and quality of hexahedra in VTK order, all cells at once."""

from __future__ import annotations

import numpy as np

CORNER_EDGES = (
    (0, 1, 3, 4),
    (1, 2, 0, 5),
    (2, 3, 1, 6),
    (3, 0, 2, 7),
    (4, 7, 5, 0),
    (5, 4, 6, 1),
    (6, 5, 7, 2),
    (7, 6, 4, 3),
)
"""Each corner and the ends of its three edges, in right-handed order."""
CHUNK = 50_000


def scaled_jacobian(points_mm: np.ndarray, cells: np.ndarray) -> np.ndarray:
    """Smallest scaled Jacobian of each cell in [-1, 1], shape (M,).

    det of the three unit edges at each corner, and of the unit principal axes at the centre; 1 is
    a cube, 0 flat, below 0 inverted. Source: Verdict library manual (SAND2007-1751), hexahedra.
    """
    quality = np.empty(len(cells))
    for begin in range(0, len(cells), CHUNK):
        corner = [points_mm[column] for column in cells[begin : begin + CHUNK].T]
        worst = _unit_triple(*_principal_axes(corner))
        for start, *ends in CORNER_EDGES:
            edges = [corner[end] - corner[start] for end in ends]
            worst = np.minimum(worst, _unit_triple(*edges))
        quality[begin : begin + CHUNK] = worst
    return quality


def hex_volumes(points_mm: np.ndarray, cells: np.ndarray) -> np.ndarray:
    """Exact volume of each trilinear cell [mm3], shape (M,).

    Source: Grandy, Efficient computation of volume of hexahedral cells, UCRL-ID-128886, 1997.
    """
    x = [points_mm[column] for column in np.asarray(cells).T]
    twelfths = (
        _triple(x[3] - x[1] + x[7] - x[2], x[6] - x[3], x[2] - x[0])
        + _triple(x[4] - x[3] + x[5] - x[7], x[6] - x[4], x[7] - x[0])
        + _triple(x[1] - x[4] + x[2] - x[5], x[6] - x[1], x[5] - x[0])
    )
    return twelfths / 12.0


def _principal_axes(x: list[np.ndarray]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    along_0 = (x[1] - x[0]) + (x[2] - x[3]) + (x[5] - x[4]) + (x[6] - x[7])
    along_1 = (x[3] - x[0]) + (x[2] - x[1]) + (x[7] - x[4]) + (x[6] - x[5])
    along_2 = (x[4] - x[0]) + (x[5] - x[1]) + (x[6] - x[2]) + (x[7] - x[3])
    return along_0, along_1, along_2


def _triple(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> np.ndarray:
    return (
        a[:, 0] * (b[:, 1] * c[:, 2] - b[:, 2] * c[:, 1])
        + a[:, 1] * (b[:, 2] * c[:, 0] - b[:, 0] * c[:, 2])
        + a[:, 2] * (b[:, 0] * c[:, 1] - b[:, 1] * c[:, 0])
    )


def _unit_triple(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> np.ndarray:
    size_2 = np.einsum("ij,ij->i", a, a) * np.einsum("ij,ij->i", b, b)
    size = np.sqrt(size_2 * np.einsum("ij,ij->i", c, c))
    return _triple(a, b, c) / np.maximum(size, 1e-300)
