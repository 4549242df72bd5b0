"""Bodies that touch, tessellated so that they share their triangles, and their overlap.

Two bodies that share a curved face are tessellated each in its own way, and their chords overlap
by several mm3 although the bodies do not. A general fuse makes the bodies share the very faces
where they touch; then triangles agree to the last bit and the overlap of the meshes is that of
the bodies. manifold3d measures it.
"""

# OCP has no type stubs.
# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

from collections.abc import Mapping
from itertools import combinations
from typing import Any

import numpy as np

from workbench.core.errors import GeometryError

SAME_VOLUME = 1e-5
"""Relative change that is OCCT's quadrature on newly trimmed faces, seen up to 2e-6."""


def share_faces(bodies: Mapping[str, Any]) -> dict[str, Any]:
    """The same bodies with common faces where they touch.

    Raises:
        GeometryError: If bodies overlap, so that one comes back in pieces or changed in volume.
    """
    from build123d.topology import Shape
    from OCP.BRepAlgoAPI import BRepAlgoAPI_BuilderAlgo
    from OCP.collections import List_TopoDS_Shape

    solids = {name: _only_solid(name, body) for name, body in bodies.items()}
    arguments = List_TopoDS_Shape()
    for solid in solids.values():
        arguments.Append(solid.wrapped)
    fuse = BRepAlgoAPI_BuilderAlgo()
    fuse.SetArguments(arguments)
    fuse.SetRunParallel(False)
    fuse.Build()
    shared = {}
    for name, solid in solids.items():
        images = list(fuse.Modified(solid.wrapped)) or [solid.wrapped]
        if len(images) != 1:
            raise _overlapping(name, f"comes in {len(images)} pieces")
        shared[name] = Shape.cast(images[0])
        before, after = solid.volume, shared[name].volume
        if abs(after - before) > SAME_VOLUME * before:
            raise _overlapping(name, f"has {after:.6g} mm3 instead of {before:.6g} mm3")
    return shared


def overlaps_mm3(
    meshes: Mapping[str, tuple[np.ndarray, np.ndarray]],
) -> dict[tuple[str, str], float]:
    """Volume common to each pair of closed meshes, given as points (N, 3) [mm] and faces (M, 3)."""
    solids = {name: _manifold(name, *mesh) for name, mesh in meshes.items()}
    return {
        (one, other): max(0.0, float((solids[one] ^ solids[other]).volume()))
        for one, other in combinations(solids, 2)
    }


def piece_count(points_mm: np.ndarray, faces: np.ndarray) -> int:
    """Bodies in a closed mesh, told by vertices that faces connect."""
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    start, stop = faces.ravel(), np.roll(faces, 1, axis=1).ravel()
    links = coo_matrix((np.ones(len(start)), (start, stop)), (len(points_mm), len(points_mm)))
    group = connected_components(links, directed=False)[1]
    return len(np.unique(group[faces[:, 0]]))


def _manifold(name: str, points_mm: np.ndarray, faces: np.ndarray) -> Any:
    import manifold3d

    mesh = manifold3d.Mesh64(
        vert_properties=np.ascontiguousarray(points_mm, dtype=np.float64),
        tri_verts=np.ascontiguousarray(faces, dtype=np.uint64),
    )
    solid = manifold3d.Manifold(mesh)
    if solid.status() != manifold3d.Error.NoError:
        raise GeometryError(
            f"{name} is not a closed body: {solid.status().name}",
            hint="change the last parameter a little",
            at="shape",
        )
    return solid


def _only_solid(name: str, body: Any) -> Any:
    solids = body.solids()
    if len(solids) != 1:
        raise _overlapping(name, f"has {len(solids)} solids")
    return solids[0]


def _overlapping(name: str, reason: str) -> GeometryError:
    return GeometryError(
        f"{name} {reason} after joining it to its neighbours",
        hint="raise mould.clearance_mm, or change the last shape parameter a little",
        at="mould",
    )
