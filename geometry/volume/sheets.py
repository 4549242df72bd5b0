"""Two sheets of quadrilaterals on the inner and outer face of a wall, node for node.

What hexahedra are stacked between. A cap's sheets end on the base plane; a slab's end on its
free sides, which belong to the sensing surface.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from geometry.surface.surface import vertex_normals
from geometry.volume.curved import CurvedSurface
from geometry.volume.ogrid import LIFT_MM, NO_GROUPS, Pace, RayGrid, axis_of, on_base, ray_grid
from geometry.volume.skins import curved_region, labelled_faces
from workbench.core.result.results import Label, LabelledSurface


@dataclass(frozen=True, kw_only=True, slots=True)
class Sheets:
    """Nodes on both faces of a wall."""

    inside: np.ndarray
    """Nodes on the inner face [mm], shape (N, 3)."""
    outside: np.ndarray
    """Nodes on the outer face [mm], shape (N, 3)."""
    quads: np.ndarray
    """Nodes of each cell, counter-clockwise from outside the sensor, shape (Q, 4), int32."""
    ring: np.ndarray
    """Nodes on the border, counter-clockwise from above, shape (R,), int32."""
    rim: Label
    """What lies between the two borders: BASE, or OUTER for a slab's free sides."""
    groups: np.ndarray = field(default_factory=lambda: NO_GROUPS)
    """Four cells that make a larger one, as `RayGrid.groups`."""


def cap_sheets(membrane: LabelledSurface, pace: Pace) -> Sheets:
    """Sheets of a cap that stands on the base plane, by rays from its axis.

    Raises:
        MeshingError: If a ray misses a face.
    """
    grid, inside, outer = _inner_sheet(membrane, pace)
    outside = outer.points(grid.origins, grid.directions)
    return _cap(grid, inside, outside)


def offset_sheets(membrane: LabelledSurface, pace: Pace) -> Sheets:
    """Sheets of a cap whose outer nodes lie along the inner face's normals.

    Rays from the axis pass by what stands steeply on a flat top (a paw's beads), these do not.

    Raises:
        MeshingError: If a ray misses a face.
    """
    grid, inside, outer = _inner_sheet(membrane, pace)
    normals = vertex_normals(inside, np.concatenate([grid.quads[:, :3], grid.quads[:, [0, 2, 3]]]))
    start = inside.copy()
    start[grid.ring, 2] = LIFT_MM
    normals[grid.ring, 2] = 0.0
    normals[grid.ring] /= np.linalg.norm(normals[grid.ring], axis=1, keepdims=True)
    return _cap(grid, inside, outer.points(start, normals))


def _inner_sheet(
    membrane: LabelledSurface, pace: Pace
) -> tuple[RayGrid, np.ndarray, CurvedSurface]:
    """Rays of a cap, where they meet the inner face, and the outer face."""
    outer = curved_region(membrane, Label.OUTER)
    inner = curved_region(membrane, Label.INNER)
    inner_points = membrane.points_mm[labelled_faces(membrane, Label.INNER)].reshape(-1, 3)
    grid = ray_grid(outer, axis_of(inner_points), pace)
    return grid, on_base(inner.points(grid.origins, grid.directions), grid), outer


def _cap(grid: RayGrid, inside: np.ndarray, outside: np.ndarray) -> Sheets:
    return Sheets(
        inside=inside,
        outside=on_base(outside, grid),
        quads=grid.quads,
        ring=grid.ring,
        rim=Label.BASE,
        groups=grid.groups,
    )
