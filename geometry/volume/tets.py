"""Tetrahedra in any closed surface, for solvers that want them.

fTetWild (Hu, Schneider, Wang, Zorin, Panozzo, Fast tetrahedral meshing in the wild, 2020) fills an
evenly remeshed coarse surface: its time grows with the input's triangles, and the body's own
tessellation takes minutes. It needs neither hexahedra nor a star-shaped wall, so pins and suckers
do. A node on the surface carries the regions of the faces that meet there.

It cannot be cancelled and holds Python's lock for its whole run, which is why the stage runs in a
worker process; it leaves a file in the working folder, which is why it gets one of its own.
"""

from __future__ import annotations

import contextlib
import tempfile
from typing import Any

import numpy as np

from geometry.surface.remesh import remesh
from geometry.surface.transfer import face_regions, node_regions
from geometry.volume.quality import tetrahedron_quality
from workbench.core.base.errors import MeshingError
from workbench.core.base.monitor import Monitor, silent
from workbench.core.result.results import LabelledSurface, Solid, VolumeMesh

ENVELOPE = 0.03
"""Distance over the edge by which the surface may move."""
STOP_ENERGY = 30.0
"""Conformal energy at which improvement ends; 3 is regular, 10 the tool's own default."""
FACES = ((0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3))
"""Corners of each face, counter-clockwise from outside a tetrahedron in VTK order."""
VOLUME_SHARE = 0.02
"""Relative error of volume above which the result is not this body."""


def tetrahedra(solid: Solid, edge_mm: float, monitor: Monitor = silent) -> VolumeMesh:
    """Fill the elastomer with tetrahedra.

    Args:
        solid: The body.
        edge_mm: Edge of a tetrahedron [mm].
        monitor: Told when the long part begins; it cannot report from within.

    Raises:
        MeshingError: If pytetwild is not installed, or the result is not this body.
    """
    monitor(0.0, "remeshing the surface")
    surface = remesh(solid.membrane, edge_mm)
    monitor(0.05, "filling with tetrahedra, about a minute")
    points, cells = _fill(surface, edge_mm)
    corner = points[cells]
    volumes = np.einsum(
        "ij,ij->i",
        np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]),
        corner[:, 3] - corner[:, 0],
    )
    volume_mm3 = float(volumes.sum()) / 6.0
    ratio = volume_mm3 / solid.volume_mm3
    if not volumes.size or volumes.min() <= 0.0 or abs(ratio - 1.0) > VOLUME_SHARE:
        raise MeshingError(
            f"tetrahedra fill {ratio:.1%} of the elastomer, and "
            f"{np.count_nonzero(volumes <= 0.0)} of {len(cells)} are inverted",
            hint="lower meshing.tet_mm, for example to half the wall",
            at="meshing.tet_mm",
        )
    faces = boundary_faces(cells)
    labels, numbers = face_regions(solid.membrane, points, faces)
    node_labels, node_numbers = node_regions(len(points), faces, labels, numbers)
    return VolumeMesh(
        points_mm=points,
        cells=cells,
        labels=node_labels,
        quality=tetrahedron_quality(points, cells).astype(np.float32),
        layers=0,
        volume_mm3=volume_mm3,
        numbers=node_numbers,
    )


def boundary_faces(cells: np.ndarray) -> np.ndarray:
    """Faces of tetrahedra (M, 4) that no other shares, outward, shape (F, 3)."""
    faces = cells[:, FACES].reshape(-1, 3)
    _, first, count = np.unique(
        np.sort(faces, axis=1), axis=0, return_index=True, return_counts=True
    )
    return faces[np.sort(first[count == 1])]


def _fill(surface: LabelledSurface, edge_mm: float) -> tuple[np.ndarray, np.ndarray]:
    """Nodes (N, 3) [mm] and tetrahedra (M, 4) in VTK order."""
    tetwild = _tetwild()
    size_mm = float(np.linalg.norm(np.ptp(surface.points_mm, axis=0)))
    with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
        points, cells = tetwild.tetrahedralize(
            surface.points_mm,
            surface.faces,
            edge_length_abs=edge_mm,
            epsilon=ENVELOPE * edge_mm / size_mm,
            stop_energy=STOP_ENERGY,
            # The surface is even already; simplifying it doubles the time.
            simplify=False,
            quiet=True,
            vtk_ordering=True,
        )
    return np.asarray(points, dtype=np.float64), np.asarray(cells, dtype=np.int32)


def _tetwild() -> Any:
    try:
        import pytetwild
    except ImportError as error:
        raise MeshingError(
            f"pytetwild, which makes tetrahedra, cannot be loaded: {error}",
            hint="install it with `pip install pytetwild`, or use the hexahedra",
            at="meshing.tet_mm",
        ) from error
    return pytetwild
