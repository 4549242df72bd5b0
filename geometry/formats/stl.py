"""Reading STL files: binary or text, to triangles and welded vertices."""

from __future__ import annotations

import numpy as np

from workbench.core.base.errors import DesignError

BULK_PERCENT, FAR = 90.0, 1e4
"""A vertex so many times farther out than nine tenths of all is no part of a body."""


def stl_corners(data: bytes, name: str, *, at: str) -> np.ndarray:
    """Triangles of an STL file, shape (M, 3, 3), float64, in the file's unit.

    Raises:
        DesignError: If it is no STL, is empty, or holds numbers that are not finite.
    """
    corners = _binary_corners(data)
    if corners is None:
        corners = _text_corners(data, name, at)
    if not len(corners):
        raise DesignError(f"{name} has no faces", hint="export the body, not an empty file", at=at)
    if not np.isfinite(corners).all():
        bad = int((~np.isfinite(corners)).any(axis=(1, 2)).sum())
        raise DesignError(
            f"{name} has {bad} faces with NaN or infinite coordinates",
            hint="repair the mesh in the program that made it",
            at=at,
        )
    expect_together(corners, name, at=at)
    return corners


def expect_together(corners: np.ndarray, name: str, *, at: str) -> None:
    """Refuse triangles (M, 3, 3) of which a few lie absurdly far from all others.

    That is how a flipped bit of an exponent looks; beside such a size the body would be a point.

    Raises:
        DesignError: Naming the place.
    """
    flat = corners.reshape(-1, 3)
    middle = np.median(flat, axis=0)
    away = np.abs(flat - middle).max(axis=1)
    bulk, farthest = float(np.percentile(away, BULK_PERCENT)), int(np.argmax(away))
    if away[farthest] > FAR * bulk > 0.0:
        x, y, z = flat[farthest]
        raise DesignError(
            f"{name} has a vertex at ({x:.3g}, {y:.3g}, {z:.3g}), {away[farthest] / bulk:.2g} "
            "times as far out as the others; the file is damaged",
            hint="export the body again from the program that made it",
            at=at,
        )


def welded(corners: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Vertices (N, 3) and triangles (M, 3) of loose triangles; those that collapse are dropped.

    STL repeats every vertex in float32; equal ones have equal bits apart from the sign of zero.
    """
    points, faces = np.unique(corners.reshape(-1, 3) + 0.0, axis=0, return_inverse=True)
    faces = faces.reshape(-1, 3)
    return points, faces[np.all(faces != np.roll(faces, 1, axis=1), axis=1)]


def sewn(points: np.ndarray, faces: np.ndarray, within: float) -> tuple[np.ndarray, np.ndarray]:
    """Vertices and triangles with vertices that are nearly one made one; collapsed ones dropped.

    Some programs round the corners of one place differently, or write 0 beside 1e-9.

    Args:
        points: Vertices, shape (N, 3).
        faces: Triangles, shape (M, 3).
        within: Distance up to which two vertices are one.
    """
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components
    from scipy.spatial import KDTree

    first, second = KDTree(points).query_pairs(within, output_type="ndarray").reshape(-1, 2).T
    links = coo_matrix((np.ones(len(first)), (first, second)), (len(points), len(points)))
    _, place = connected_components(links, directed=False)
    _, kept = np.unique(place, return_index=True)
    faces = place[faces]
    return points[kept], faces[np.all(faces != np.roll(faces, 1, axis=1), axis=1)]


def _binary_corners(data: bytes) -> np.ndarray | None:
    """Triangles of a binary STL, shape (M, 3, 3), or None when its length says it is none."""
    if len(data) < 84:
        return None
    count = int(np.frombuffer(data, dtype="<u4", count=1, offset=80)[0])
    if len(data) != 84 + 50 * count:
        return None
    record = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("spare", "<u2")])
    return np.frombuffer(data, dtype=record, count=count, offset=84)["corners"].astype(np.float64)


def _text_corners(data: bytes, name: str, at: str) -> np.ndarray:
    """Triangles of a text STL, shape (M, 3, 3)."""
    if not data.lstrip()[:5].lower() == b"solid":
        raise _not_stl(name, at)
    words = [line.split()[1:] for line in data.splitlines() if line.split()[:1] == [b"vertex"]]
    try:
        corners = np.array(words, dtype=np.float64)
        return corners.reshape(-1, 3, 3)
    except ValueError as error:
        raise _not_stl(name, at) from error


def _not_stl(name: str, at: str) -> DesignError:
    return DesignError(
        f"{name} is not an STL file", hint="export the body as binary or text STL", at=at
    )
