"""Bodies from signed distance fields: what is built when the CAD kernel fails.

The wall is where the outer field is negative and the core's positive: max(outer, -core) < 0. It is
sampled on a cubic grid and its zero set is triangulated by marching cubes (VTK's flying edges);
manifold3d then cuts the closed surface at the base plane z = 0, so its rim is flat and sharp. A
face belongs to the field that vanishes there. Near edges the surface is rounded by about a grid
step; elsewhere it is off by step^2 / (8 R) on a bend of radius R.

Only blocks of the grid that the surface may pass through are sampled in full, by the distance at
their middle; that makes a step of 0.2 mm, which thin walls need, affordable.

Fields are duck-typed (`outer`, `core`, `cavity`, `low_mm`, `high_mm`, `marks`, `base`), because
geometry knows no families. Source: Lorensen and Cline, Marching cubes, 1987. Leaves out: B-rep
text, except that of the foot; walls thinner than twice the finest step tear and are refused.
"""

# manifold3d has no type stubs.
# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

from typing import Any

import numpy as np

from geometry.body.csg_mesh import arrays
from geometry.body.solid import COARSE_ANGLE_RAD, COARSE_TOLERANCE_MM, brep_bytes, label_surface
from geometry.surface.isosurface import isosurface
from geometry.surface.regions import mark_regions
from geometry.surface.surface import mesh_volume, on_plane, open_edges
from workbench.core.base.errors import MeshingError
from workbench.core.result.marks import Field
from workbench.core.result.results import BodyMethod, Label, LabelledSurface, Solid

STEP_MM = 0.4
"""Grid step for walls of 1 mm and more [mm]."""
FINEST_MM = 0.2
STEPS_THROUGH = 2.5
"""Grid steps through the thinnest wall, so that it does not tear."""
MARGIN = 2
"""Grid steps around the body, at least."""
OFF_BASE = 0.37
"""Part of a step by which grid planes miss z = 0: a grid point on a flat face gives slivers."""
BLOCK = 6
"""Grid points along the edge of a block that is sampled in full or not at all."""
SLACK = 2.0
"""Factor of caution on the distance at a block's middle: the fields are exact near 0 only."""


def solid_from_fields(fields: Any, *, wall_mm: float, support_mm: float) -> Solid:
    """The body whose surfaces are the zero sets of a family's fields.

    Args:
        wall_mm: Thickness of the elastomer: the grid is made fine enough for it.
        support_mm: Thickness of the support, likewise.

    Raises:
        MeshingError: If a body is empty, open, or the elastomer not in one piece.
    """
    box = fields.low_mm, fields.high_mm
    membrane = between(fields.outer, fields.core, box, step_mm=step_for(wall_mm), what="elastomer")
    support = between(fields.core, fields.cavity, box, step_mm=step_for(support_mm), what="support")
    membrane = mark_regions(membrane, fields.marks.regions)
    empty = np.zeros(0, dtype=np.uint8)
    coarse = {"tolerance_mm": COARSE_TOLERANCE_MM, "angle_rad": COARSE_ANGLE_RAD}
    return Solid(
        membrane=membrane,
        support=support,
        base=label_surface(fields.base, None, **coarse),
        outer_brep=empty,
        core_brep=empty,
        membrane_brep=empty,
        support_brep=empty,
        base_brep=brep_bytes(fields.base),
        volume_mm3=mesh_volume(membrane.points_mm, membrane.faces),
        method=BodyMethod.SIGNED_DISTANCE,
        tips_mm=np.asarray(fields.marks.tips_mm, dtype=np.float64).reshape(-1, 3),
        tip_radius_mm=fields.marks.tip_radius_mm,
        backing_mm=fields.marks.backing_mm,
    )


def step_for(wall_mm: float) -> float:
    """Grid step that a wall of this thickness needs [mm]."""
    return min(STEP_MM, max(FINEST_MM, wall_mm / STEPS_THROUGH))


def between(
    outer: Field,
    core: Field,
    box_mm: tuple[tuple[float, float, float], tuple[float, float, float]],
    *,
    step_mm: float,
    what: str,
) -> LabelledSurface:
    """Closed surface of what is inside one field, outside the other and above z = 0.

    Args:
        box_mm: Corners of a box around it.
        what: Name of the body, for the message.

    Raises:
        MeshingError: If there is nothing, or the surface is open or in several pieces.
    """
    from manifold3d import Manifold, Mesh64

    def wall(points_mm: np.ndarray) -> np.ndarray:
        # Below the base the fields may say anything: what is on it goes straight down.
        above = np.column_stack([points_mm[:, :2], np.maximum(points_mm[:, 2], 0.0)])
        return np.maximum(outer(above), -core(above))

    found = isosurface(*sampled(wall, box_mm, step_mm), step_mm)
    if found is None:
        raise _unusable(what, "is empty")
    closed = Manifold(Mesh64(found[0], found[1].astype(np.uint64)))
    if closed.is_empty():
        raise _unusable(what, f"is not closed ({closed.status().name})")
    points, faces = arrays(closed.trim_by_plane((0.0, 0.0, 1.0), 0.0))
    gaps = open_edges(faces)
    if gaps or not len(faces):
        raise _unusable(what, f"has {gaps} open edges")
    centre = points[faces].mean(axis=1)
    labels = np.where(
        np.abs(outer(centre)) <= np.abs(core(centre)), Label.OUTER, Label.INNER
    ).astype(np.uint8)
    labels[on_plane(points, faces)] = Label.BASE
    return LabelledSurface(points_mm=points, faces=faces, labels=labels)


def sampled(
    field: Field,
    box_mm: tuple[tuple[float, float, float], tuple[float, float, float]],
    step_mm: float,
) -> tuple[np.ndarray, np.ndarray]:
    """A field on a grid around a box, exact wherever the grid's cells may hold a zero.

    Returns:
        Values [mm], shape (X, Y, Z), a multiple of `BLOCK` each, positive on the border; the
        first grid point [mm], shape (3,).
    """
    low = np.array(box_mm[0]) - MARGIN * step_mm
    low[2] = (np.floor(low[2] / step_mm) - 1.0 + OFF_BASE) * step_mm
    blocks = np.ceil((np.array(box_mm[1]) + MARGIN * step_mm - low) / (BLOCK * step_mm)).astype(int)
    middle = (
        np.indices(tuple(blocks.tolist())).reshape(3, -1).T * BLOCK + (BLOCK - 1) / 2
    ) * step_mm + low
    value = field(middle)
    # A cell between blocks has a corner in each, so a block answers for a step beyond itself.
    reach = SLACK * np.sqrt(3.0) * (BLOCK + 1) / 2 * step_mm
    near = np.flatnonzero(np.abs(value) < reach)
    corner = np.indices((BLOCK,) * 3).reshape(3, -1).T - (BLOCK - 1) / 2
    fine = np.repeat(value[:, None], BLOCK**3, axis=1)
    fine[near] = field((middle[near, None] + corner * step_mm).reshape(-1, 3)).reshape(-1, BLOCK**3)
    grid = fine.reshape(*blocks, BLOCK, BLOCK, BLOCK).transpose(0, 3, 1, 4, 2, 5)
    grid = grid.reshape(blocks * BLOCK)
    for axis in range(3):
        edge = np.moveaxis(grid, axis, 0)
        edge[[0, -1]] = np.maximum(edge[[0, -1]], step_mm)
    return grid, low


def _unusable(what: str, why: str) -> MeshingError:
    return MeshingError(
        f"by signed distance the {what} {why}",
        hint="change the last shape parameter a little, or raise the thickness of the layer",
        at="shape",
    )
