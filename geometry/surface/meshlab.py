"""The only door to pymeshlab.

pymeshlab is GPL-3 and may be left out: it is imported here and nowhere else, and only when one of
these functions runs.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from workbench.core.base.errors import MeshingError

CREASE_DEG = 35.0
PASSES = 6


def isotropic(
    points_mm: np.ndarray, faces: np.ndarray, edge_mm: float, chosen: np.ndarray | None
) -> tuple[np.ndarray, np.ndarray]:
    """Triangles with edges of about `edge_mm` on the same surface.

    Args:
        points_mm: Vertices [mm], shape (N, 3).
        faces: Triangles, shape (M, 3).
        edge_mm: Edge asked for.
        chosen: Numbers of the faces to divide, or None for all.

    Raises:
        MeshingError: If pymeshlab is not installed.
    """
    meshlab = _meshlab(at="meshing.hex_mm", hint=", or choose a shape that hexahedra suit")
    meshes = meshlab.MeshSet(verbose=False)
    marks = np.zeros(len(faces))
    marks[chosen] = 1.0
    meshes.add_mesh(meshlab.Mesh(points_mm, faces, f_scalar_array=marks))
    if chosen is not None:
        meshes.compute_selection_by_condition_per_face(condselect="fq > 0.5")
    meshes.meshing_isotropic_explicit_remeshing(
        targetlen=meshlab.PureValue(edge_mm),
        iterations=PASSES,
        featuredeg=CREASE_DEG,
        checksurfdist=False,
        selectedonly=chosen is not None,
    )
    result = meshes.current_mesh()
    points = np.array(result.vertex_matrix(), dtype=np.float64)
    triangles = np.array(result.face_matrix(), dtype=np.int64)
    used, compact = np.unique(triangles, return_inverse=True)
    return points[used], compact.reshape(-1, 3).astype(np.int32)


def crossing_faces(points_mm: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Which faces cut through another one, shape (M,), bool.

    Raises:
        MeshingError: If pymeshlab is not installed; whoever reads a file says which.
    """
    meshlab = _meshlab()
    meshes = meshlab.MeshSet(verbose=False)
    meshes.add_mesh(meshlab.Mesh(points_mm, faces))
    meshes.compute_selection_by_self_intersections_per_face()
    return np.asarray(meshes.current_mesh().face_selection_array(), dtype=bool)


def _meshlab(*, at: str = "", hint: str = "") -> Any:
    try:
        import pymeshlab
    except ImportError as error:
        raise MeshingError(
            f"pymeshlab, which reads and divides shapes like this one, cannot be loaded: {error}",
            hint=f"install it with `pip install pymeshlab`{hint}",
            at=at,
        ) from error
    return pymeshlab
