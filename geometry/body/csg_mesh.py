"""Descriptions to triangles by manifold3d: exact, always closed, milliseconds.

Parts that are cut by the same body share its very triangles, so parts that touch do not overlap.
Source: Lalish, manifold, https://github.com/elalish/manifold (guaranteed manifold output).
"""

from __future__ import annotations

import functools
import math
from collections.abc import Mapping
from itertools import combinations
from typing import Any

import numpy as np

from geometry.body import csg
from workbench.core.base.errors import GeometryError

CHORD_MM = 0.02
"""Distance of a chord from the circle it stands for [mm]."""
FEWEST_SEGMENTS = 64
"""Their polygon has 0.16 % less area than the circle: less than STL and STEP may differ."""
SLIVER_MM3 = 1e-9


def evaluate(node: csg.Node) -> Any:
    """The `manifold3d.Manifold` of a description.

    Raises:
        GeometryError: If a cast body in it is not closed.
    """
    import manifold3d

    match node:
        case csg.Box():
            size = np.subtract(node.high_mm, node.low_mm)
            return manifold3d.Manifold.cube(size).translate(node.low_mm)
        case csg.Cone():
            return _cone(node)
        case csg.Prism():
            section = manifold3d.CrossSection([node.polygon_mm.tolist()])
            height = node.high_mm - node.low_mm
            return manifold3d.Manifold.extrude(section, height).translate((0, 0, node.low_mm))
        case csg.Body():
            return closed("body", node.points_mm, node.faces)
        case csg.Union():
            return manifold3d.Manifold.batch_boolean(
                [evaluate(part) for part in node.parts], manifold3d.OpType.Add
            )
        case csg.Difference():
            return manifold3d.Manifold.batch_boolean(
                [evaluate(part) for part in (node.body, *node.tools)], manifold3d.OpType.Subtract
            )
        case csg.Intersection():
            return evaluate(node.body) ^ evaluate(node.other)
        case csg.Placed():
            return evaluate(node.body).transform(node.matrix)


def closed(
    name: str, points_mm: np.ndarray, faces: np.ndarray, numbers: np.ndarray | None = None
) -> Any:
    """The manifold of a closed mesh, points (N, 3) [mm] and faces (M, 3).

    Args:
        numbers: Number that each face and what is cut from it carries, shape (M,).

    Raises:
        GeometryError: If it is not closed.
    """
    import manifold3d

    # Copies: stored results are read-only, and the binding takes writable arrays alone.
    mesh = manifold3d.Mesh64(
        vert_properties=np.array(points_mm, dtype=np.float64, order="C"),
        tri_verts=np.array(faces, dtype=np.uint64, order="C"),
        face_id=np.array([] if numbers is None else numbers, dtype=np.uint64),
    )
    solid = manifold3d.Manifold(mesh)
    if solid.status() != manifold3d.Error.NoError:
        raise GeometryError(
            f"{name} is not a closed body: {solid.status().name}",
            hint="change the last parameter a little",
            at="shape",
        )
    return solid


def arrays(solid: Any) -> tuple[np.ndarray, np.ndarray]:
    """Points (N, 3) [mm], float64, and faces (M, 3), int32, of a manifold."""
    mesh = solid.to_mesh64()
    points = np.array(mesh.vert_properties, dtype=np.float64)[:, :3]
    return points, np.array(mesh.tri_verts, dtype=np.int32).reshape(-1, 3)


def overlaps_mm3(solids: Mapping[str, Any]) -> dict[tuple[str, str], float]:
    """Volume common to each pair of manifolds [mm3]."""
    return {
        (one, other): _shared_mm3(solids[one], solids[other])
        for one, other in combinations(solids, 2)
    }


def _shared_mm3(one: Any, other: Any) -> float:
    """What two bodies share: their intersection, and what the second takes from the first.

    Where bodies share faces to the last bit, either may hold slivers of 1e-4 mm3 of nothing; a true
    overlap is in both.
    """
    common = float((one ^ other).volume())
    taken = float(one.volume() - (one - other).volume()) if common > SLIVER_MM3 else common
    return max(0.0, min(common, taken))


@functools.cache
def segments(radius_mm: float) -> int:
    """Chords of a circle so that none is farther than `CHORD_MM` from it; a multiple of 4."""
    if radius_mm <= CHORD_MM:
        return FEWEST_SEGMENTS
    count = math.pi / math.acos(1.0 - CHORD_MM / radius_mm)
    return max(FEWEST_SEGMENTS, 4 * math.ceil(count / 4))


def _cone(node: csg.Cone) -> Any:
    import manifold3d

    count = segments(round(max(node.low_radius_mm, node.high_radius_mm), 6))
    solid = manifold3d.Manifold.cylinder(
        node.high_mm - node.low_mm, node.low_radius_mm, node.high_radius_mm, count
    )
    return solid.translate((0.0, 0.0, node.low_mm))
