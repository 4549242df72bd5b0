"""Indenters: STL, OBJ and STEP files in, closed meshes out, and meshes of the simplest kinds.

Body frame as in `workbench.core.press.indenter`: the origin is the shape's centre, +Z points away
from the skin, so the -Z side meets it.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from geometry.formats.obj import obj_corners
from geometry.formats.stl import sewn, stl_corners, welded
from geometry.intake.intake import read_body
from geometry.surface.primitives import rounded_box, rounded_revolution, sphere
from geometry.surface.surface import mesh_volume, open_edges
from workbench.core.base.errors import DesignError, shown
from workbench.core.design.imported import ImportedBody, ReadBody, body_file
from workbench.core.design.turning import turn_matrix
from workbench.core.objects.kind import Shape
from workbench.core.press.indenter import Indenter, IndenterMesh

LARGEST_FILE_MB = 64
MOST_TRIANGLES = 1_000_000
"""Sampling the distance of more takes minutes."""
SMALLEST_SHARE = 1e-6
"""Volume over that of the bounding box below which a mesh encloses nothing."""
SEWN_WIDTHS = 1e-6
"""Distance over the width up to which the corners of an open mesh are taken for one."""
ENDINGS = (".stl", ".obj", ".step", ".stp")
AT = "indenter"


def load_mesh(path: str | Path) -> IndenterMesh:
    """Read an STL, OBJ or STEP file as a closed body about the origin.

    Raises:
        DesignError: If the file is missing, too large, of another kind, or not a closed body.
    """
    file = Path(path)
    ending = file.suffix.lower()
    if ending in (".step", ".stp"):
        return _load_step(file)
    if ending != ".obj":
        return load_stl(file)
    _check_size(file)
    return _closed_mesh(obj_corners(file.read_bytes(), file.name, at=AT), file.name)


def load_stl(path: str | Path) -> IndenterMesh:
    """Read an STL file, weld it, turn it outward and centre it on its bounding box.

    Raises:
        DesignError: If the file is missing, too large, no STL, or not a closed body.
    """
    file = Path(path)
    _check_size(file)
    return _closed_mesh(stl_corners(file.read_bytes(), file.name, at=AT), file.name)


def _load_step(file: Path) -> IndenterMesh:
    """The one solid of a STEP file, in mm whatever the file's unit."""
    _check_size(file)
    try:
        body = read_body(ImportedBody(outer=body_file(file.name, file.read_bytes())))
    except DesignError as error:
        error.at = AT
        raise
    return mesh_of_body(body, file.name)


def mesh_of_body(body: ReadBody, name: str) -> IndenterMesh:
    """A body that was read, as an object; `name` is for people.

    Raises:
        DesignError: If it encloses no volume.
    """
    return _oriented(body.outer.points_mm, body.outer.faces, name)


def largest_width(mesh: IndenterMesh) -> float:
    """Longest side of the bounding box [mm]."""
    return float(np.ptp(mesh.points_mm, axis=0).max())


def scaled(mesh: IndenterMesh, size_mm: float) -> IndenterMesh:
    """The mesh with its largest width made `size_mm`."""
    factor = size_mm / largest_width(mesh)
    return IndenterMesh(points_mm=mesh.points_mm * factor, faces=mesh.faces, notice=mesh.notice)


def primitive_mesh(indenter: Indenter) -> tuple[np.ndarray, np.ndarray]:
    """Closed outward mesh of a sphere, cube, cone or cylinder, or a loaded mesh, as it is turned.

    Texture and the rounding of a mesh are left out; see `workbench.live.indenter_display`.

    Returns:
        Points [mm], shape (N, 3), float64; faces, shape (M, 3), int32.

    Raises:
        DesignError: If a cone is too small for its edge radius.
    """
    mesh = indenter.standing_mesh
    if mesh is not None:
        return mesh.points_mm, mesh.faces
    points, faces = _upright_mesh(indenter)
    return points @ turn_matrix(indenter.turn_deg).T if indenter.turned else points, faces


def _upright_mesh(indenter: Indenter) -> tuple[np.ndarray, np.ndarray]:
    half, radius, kind = indenter.size_mm / 2, indenter.edge_radius_mm, indenter.record
    if kind.numbers is not None:
        # Refuses an edge radius that leaves nothing of the body.
        kind.numbers(indenter.size_mm, radius)
    if kind.shape is Shape.SPHERE:
        return sphere(half)
    if kind.corners_mm is None:
        return rounded_box(half, radius)
    points, faces = rounded_revolution(list(kind.corners_mm(indenter.size_mm)), radius)
    if kind.shape is Shape.CYLINDER_Y:
        # Axis from +Z to +Y: x stays, y becomes z, z becomes -y keeps the mesh right-handed.
        points = np.column_stack([points[:, 0], points[:, 2], -points[:, 1]])
    return points, faces


def _check_size(file: Path) -> None:
    if not file.is_file():
        raise DesignError(
            f"there is no file {shown(str(file))}",
            hint="give the path of an STL, OBJ or STEP file",
            at=AT,
        )
    size_mb = file.stat().st_size / 1e6
    if size_mb > LARGEST_FILE_MB:
        raise DesignError(
            f"{file.name} has {size_mb:,.0f} MB, more than {LARGEST_FILE_MB} MB",
            hint=f"reduce the mesh to under {MOST_TRIANGLES:,} triangles before loading it",
            at=AT,
        )


def _closed_mesh(corners: np.ndarray, name: str) -> IndenterMesh:
    """Weld triangles (M, 3, 3) into a closed body, refusing what is none."""
    if len(corners) > MOST_TRIANGLES:
        raise DesignError(
            f"{name} has {len(corners):,} triangles, more than {MOST_TRIANGLES:,}",
            hint="reduce the mesh, for example by quadric decimation in MeshLab",
            at=AT,
        )
    points, faces = welded(corners)
    gaps = open_edges(faces)
    if gaps:
        near = sewn(points, faces, SEWN_WIDTHS * float(np.ptp(points, axis=0).max()))
        if len(near[1]) and not open_edges(near[1]):
            (points, faces), gaps = near, 0
    if gaps:
        raise DesignError(
            f"{name} is not watertight: {gaps} open edges",
            hint="close the holes in the program that made it; faces must all point outward",
            at=AT,
        )
    return _oriented(points, faces, name)


def _oriented(points: np.ndarray, faces: np.ndarray, name: str) -> IndenterMesh:
    """The closed mesh turned outward, centred, without unused vertices."""
    used, packed = np.unique(faces, return_inverse=True)
    points, faces = points[used], packed.reshape(-1, 3)
    volume_mm3 = mesh_volume(points, faces) if len(faces) else 0.0
    width_mm = float(np.ptp(points, axis=0).max()) if len(faces) else 0.0
    if abs(volume_mm3) <= SMALLEST_SHARE * width_mm**3:
        raise DesignError(
            f"{name} encloses no volume ({abs(volume_mm3):.3g} mm3)",
            hint="an indenter must be a solid body, not a sheet",
            at=AT,
        )
    low, high = points.min(axis=0), points.max(axis=0)
    turned = volume_mm3 < 0.0
    if turned:
        faces = faces[:, ::-1]
    return IndenterMesh(
        points_mm=points - (low + high) / 2,
        faces=np.ascontiguousarray(faces, dtype=np.int32),
        notice=f"{name} was inside out and has been turned" if turned else "",
    )
