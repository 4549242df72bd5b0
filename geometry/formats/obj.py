"""Reading Wavefront OBJ files: vertices and faces only, polygons as fans of triangles.

Left out: normals, texture coordinates, materials, groups, free-form surfaces.
"""

from __future__ import annotations

import itertools

import numpy as np

from geometry.formats.stl import expect_together
from workbench.core.base.errors import DesignError


def obj_corners(data: bytes, name: str, *, at: str) -> np.ndarray:
    """Triangles of an OBJ file, shape (M, 3, 3), float64, in the file's unit.

    Raises:
        DesignError: If it is no OBJ, is empty, or names vertices that it does not have.
    """
    vertices: list[list[float]] = []
    faces: list[tuple[int, int, int]] = []
    try:
        for line in data.splitlines():
            words = line.split()
            if words[:1] == [b"v"]:
                vertices.append([float(word) for word in words[1:4]])
            elif words[:1] == [b"f"]:
                ring = [_index(word, len(vertices)) for word in words[1:]]
                faces += [(ring[0], b, c) for b, c in itertools.pairwise(ring[1:])]
        points, corners = np.array(vertices, dtype=np.float64), np.array(faces, dtype=np.int64)
        if len(corners) and (corners.min() < 0 or corners.max() >= len(points)):
            raise ValueError("a face names a vertex that is not there")
        found = points.reshape(-1, 3)[corners.reshape(-1, 3)]
    except (ValueError, IndexError, OverflowError) as error:
        raise DesignError(
            f"{name} is not an OBJ file: {error}", hint="export the body as OBJ or STL", at=at
        ) from error
    if not len(found):
        raise DesignError(f"{name} has no faces", hint="export the body, not an empty file", at=at)
    if not np.isfinite(found).all():
        raise DesignError(
            f"{name} has faces with NaN or infinite coordinates",
            hint="repair the mesh in the program that made it",
            at=at,
        )
    expect_together(found, name, at=at)
    return found


def _index(word: bytes, count: int) -> int:
    """Vertex number from 0 of `7/2/3`; negative numbers count back from the last vertex."""
    number = int(word.split(b"/")[0])
    return number - 1 if number > 0 else count + number
