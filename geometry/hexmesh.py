"""Structured hexahedra through the wall, and the skins that share their nodes.

A grid of rays from the axis meets the inner and the outer face of the membrane; nodes lie on
straight lines between the two meetings, in equal layers. Skins are the first and last layer, with
every quadrilateral split along its shorter diagonal.
"""

from __future__ import annotations

import numpy as np

from geometry.curved import CurvedSurface
from geometry.hexquality import hex_volumes, scaled_jacobian
from geometry.ogrid import RayGrid, axis_of, ray_grid
from geometry.surface import vertex_normals
from workbench.core.design import Meshing
from workbench.core.errors import MeshingError
from workbench.core.monitor import Monitor, silent
from workbench.core.results import Label, LabelledSurface, MembraneMesh, Skin, Solid, VolumeMesh

FEWEST_LAYERS = 2
CAVITY_EDGE_MM = 0.65
"""Cell of the cavity skin [mm], so that no diagonal exceeds 1 mm; it only refracts light."""


def mesh_membrane(solid: Solid, meshing: Meshing, monitor: Monitor = silent) -> MembraneMesh:
    """Mesh the wall of a membrane.

    Raises:
        MeshingError: If the wall cannot be seen whole from the axis, or a cell is inverted.
    """
    monitor(0.0, "casting rays")
    outer, inner = _region(solid.membrane, Label.OUTER), _region(solid.membrane, Label.INNER)
    inner_points = solid.membrane.points_mm[_faces(solid.membrane, Label.INNER)].reshape(-1, 3)
    grid = ray_grid(outer, axis_of(inner_points), meshing.hex_mm)
    outside = _on_base(outer.points(grid.origins, grid.directions), grid)
    inside = _on_base(inner.points(grid.origins, grid.directions), grid)
    monitor(0.3, "stacking layers")
    hexes = _stack(inside, outside, grid, meshing)
    monitor(0.8, "meshing the cavity")
    return MembraneMesh(
        hexes=hexes,
        outer=_skin(outside, grid.quads),
        inner=_skin(inside, grid.quads),
        cavity=_cavity(solid.support),
    )


def _stack(inside: np.ndarray, outside: np.ndarray, grid: RayGrid, meshing: Meshing) -> VolumeMesh:
    """Hexahedra between two node sheets, each of shape (N, 3) [mm]."""
    wall_mm = float(np.median(np.linalg.norm(outside - inside, axis=1)))
    layers = max(FEWEST_LAYERS, round(wall_mm / meshing.hex_mm))
    share = np.linspace(0.0, 1.0, layers + 1)[:, None, None]
    points = ((1.0 - share) * inside + share * outside).reshape(-1, 3)
    sheet = len(inside)
    level = sheet * np.arange(layers, dtype=np.int32)[:, None, None]
    cells = np.concatenate([grid.quads + level, grid.quads + level + sheet], axis=2)
    cells = cells.reshape(-1, 8)
    quality = scaled_jacobian(points, cells)
    good = quality > 0.0
    if not good.all():
        raise MeshingError(
            f"{np.count_nonzero(~good)} of {len(quality)} cells are inverted "
            f"(scaled Jacobian {quality.min():.3f})",
            hint="make the shape smoother or the wall more even",
            at="shape",
        )
    labels = np.zeros((layers + 1, sheet), dtype=np.uint8)
    labels[0] |= np.uint8(Label.INNER)
    labels[-1] |= np.uint8(Label.OUTER)
    labels[:, grid.ring] |= np.uint8(Label.BASE)
    return VolumeMesh(
        points_mm=points,
        cells=cells.astype(np.int32),
        labels=labels.ravel(),
        quality=quality.astype(np.float32),
        layers=layers,
        volume_mm3=float(hex_volumes(points, cells).sum()),
    )


def _cavity(support: LabelledSurface) -> Skin:
    """The air side of the support as an even grid; normals point into the support."""
    surface = _region(support, Label.INNER)
    points = support.points_mm[_faces(support, Label.INNER)].reshape(-1, 3)
    grid = ray_grid(surface, axis_of(points), CAVITY_EDGE_MM)
    return _skin(_on_base(surface.points(grid.origins, grid.directions), grid), grid.quads)


def _faces(surface: LabelledSurface, label: Label) -> np.ndarray:
    faces = surface.faces[surface.has(label)]
    if not len(faces):
        raise MeshingError(
            f"the body has no {label.name} face",
            hint="check that the wall is closed and thicker than 0.1 mm",
            at="shape",
        )
    return faces


def _region(surface: LabelledSurface, label: Label) -> CurvedSurface:
    used, faces = np.unique(_faces(surface, label), return_inverse=True)
    return CurvedSurface(surface.points_mm[used], faces.reshape(-1, 3))


def _on_base(points: np.ndarray, grid: RayGrid) -> np.ndarray:
    points[grid.ring, 2] = 0.0
    return points


def _skin(points: np.ndarray, quads: np.ndarray) -> Skin:
    corner = points[quads]
    diagonals = np.linalg.norm(corner[:, [0, 1]] - corner[:, [2, 3]], axis=2)
    # Equal to rounding counts as equal, or noise would decide which way squares are split.
    first = diagonals[:, 0] <= diagonals[:, 1] * (1.0 + 1e-6)
    split = np.where(
        first[:, None, None], quads[:, [[0, 1, 2], [0, 2, 3]]], quads[:, [[0, 1, 3], [1, 2, 3]]]
    )
    faces = split.reshape(-1, 3).astype(np.int32)
    return Skin(points_mm=points, faces=faces, normals=vertex_normals(points, faces))
