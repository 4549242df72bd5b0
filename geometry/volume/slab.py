"""Sheets of a slab: a plane bonded face, free sides, and a top that is a height over it.

The plan of the slab is divided by an O-grid: a rectangle of cells in the middle, and rows of cells
around it that follow the outline. Nodes on the outline are evenly spaced; those within are each
the mean of their neighbours, which never folds in a convex outline (Tutte, How to draw a graph,
1963). The number of rows decides how well rounded corners are met, so several are tried.

Leaves out: tops that overhang the bonded face, and outlines with dents.
"""

from __future__ import annotations

import numpy as np

from geometry.volume.curved import CurvedSurface
from geometry.volume.ogrid import NO_GROUPS, Pace, o_groups, o_quads, patch_border
from geometry.volume.sheets import Sheets
from geometry.volume.skins import labelled_faces, part_of
from workbench.core.base.errors import MeshingError
from workbench.core.result.results import Label, LabelledSurface

FLAT_MM = 1e-4
"""Height differences below this are none [mm]."""
INSET_MM = 0.04
"""Rays under the rim start this far inside it [mm]: the top's own rim is another polygon, which
may lie inside by its chords' sagitta of 0.02 mm."""
UPWARD = 0.3
"""Faces whose normal rises by more belong to the top, not to the sides."""
FEWEST = 4
MOST_ROWS = 12


def is_slab(membrane: LabelledSurface) -> bool:
    """Whether the bonded face is plane and nothing else rests on the base."""
    height = membrane.points_mm[labelled_faces(membrane, Label.INNER), 2]
    return not membrane.has(Label.BASE).any() and float(np.ptp(height)) < FLAT_MM


def slab_sheets(membrane: LabelledSurface, pace: Pace) -> Sheets:
    """Sheets on the bonded face of a slab and straight above it.

    Raises:
        MeshingError: If the outline is not one loop, or a ray upward meets nothing.
    """
    faces = labelled_faces(membrane, Label.INNER)
    height_mm = float(membrane.points_mm[faces[0, 0], 2])
    sides = _outline_sides(membrane.points_mm[_outline(faces), :2], pace)
    plan, quads, ring, groups = _best_plan(sides, paired=pace.paired)
    inside = np.column_stack([plan, np.full(len(plan), height_mm)])
    start = inside.copy()
    inward = plan.mean(axis=0) - plan[ring]
    start[ring, :2] += INSET_MM * inward / np.linalg.norm(inward, axis=1, keepdims=True)
    upward = np.broadcast_to([0.0, 0.0, 1.0], start.shape)
    outside = _top(membrane).points(start, upward)
    outside[:, :2] = plan
    return Sheets(
        inside=inside, outside=outside, quads=quads, ring=ring, rim=Label.OUTER, groups=groups
    )


def _top(membrane: LabelledSurface) -> CurvedSurface:
    outer = part_of(membrane, Label.OUTER)
    corners = outer.points_mm[outer.faces]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    rising = normal[:, 2] > UPWARD * np.linalg.norm(normal, axis=1)
    if not rising.any():
        raise MeshingError("the slab has no top", hint="check the design", at="shape")
    return CurvedSurface(outer.points_mm, outer.faces[rising])


def _outline(faces: np.ndarray) -> np.ndarray:
    """Vertices around a region, counter-clockwise from above; faces look down, shape (B,)."""
    start, stop = faces.ravel().astype(np.int64), np.roll(faces, -1, axis=1).ravel()
    span = int(faces.max()) + 1
    free = ~np.isin(start * span + stop, stop.astype(np.int64) * span + start)
    following = dict(zip(stop[free].tolist(), start[free].tolist(), strict=True))
    first = int(stop[free][0])
    loop = [first]
    while (here := following[loop[-1]]) != first:
        loop.append(here)
    if len(loop) != len(following):
        raise MeshingError(
            f"the bonded face has {len(following) - len(loop)} border edges beside its outline",
            hint="choose a shape whose bonded face has no holes",
            at="shape",
        )
    return np.array(loop)


def _outline_sides(outline: np.ndarray, pace: Pace) -> list[np.ndarray]:
    """Four sides of an outline between its diagonals, evenly divided; opposite ones alike.

    Args:
        outline: Points in plan, counter-clockwise, shape (B, 2).
        pace: Distance of points along the outline.

    Returns:
        For each side its points but the last, starting at the corner (+x, -y).
    """
    closed = np.vstack([outline, outline[:1]])
    arc = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(closed, axis=0), axis=1))])
    low, high = outline.min(axis=0), outline.max(axis=0)
    scaled = (outline - (low + high) / 2) / (high - low)
    diagonals = ((1, -1), (1, 1), (-1, 1), (-1, -1))
    corner = [arc[np.argmax(scaled @ np.array(diagonal))] for diagonal in diagonals]
    lengths = [(corner[(k + 1) % 4] - corner[k]) % arc[-1] for k in range(4)]
    counts = [pace.count((lengths[k % 2] + lengths[k % 2 + 2]) / 2, FEWEST) for k in range(4)]
    sides = []
    for begin, length, count in zip(corner, lengths, counts, strict=True):
        along = (begin + length * np.arange(count) / count) % arc[-1]
        sides.append(np.column_stack([np.interp(along, arc, closed[:, k]) for k in range(2)]))
    return sides


Plan = tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]
"""Points (N, 2), quads, ring and groups."""


def _best_plan(sides: list[np.ndarray], *, paired: bool) -> Plan:
    """The O-grid whose worst corner is squarest."""
    step = 2 if paired else 1
    most = max(step, min(MOST_ROWS, min(len(side) for side in sides) // 4))
    plans = [_plan(sides, rows, paired=paired) for rows in range(step, most + 1, step)]
    return max(plans, key=lambda plan: _least_sine(plan[0][plan[1]]))


def _plan(sides: list[np.ndarray], rows: int, *, paired: bool) -> Plan:
    from scipy.sparse import coo_matrix, diags
    from scipy.sparse.linalg import splu

    up, across = len(sides[0]), len(sides[1])
    index = np.arange((across + 1) * (up + 1), dtype=np.int32).reshape(across + 1, up + 1)
    border = patch_border(index)
    side = index.size + np.arange(rows * len(border), dtype=np.int32).reshape(rows, -1)
    quads = o_quads(index, np.vstack([border[None], side]))
    ring = side[-1]
    count = index.size + side.size
    ends = np.vstack([quads[:, [k, (k + 1) % 4]] for k in range(4)])
    ends = np.unique(np.sort(ends, axis=1), axis=0)
    links = coo_matrix((np.ones(len(ends)), (ends[:, 0], ends[:, 1])), (count, count))
    links = (links + links.T).tocsr()
    laplacian = (diags(np.asarray(links.sum(axis=1)).ravel()) - links).tocsc()
    points = np.zeros((count, 2))
    points[ring] = np.concatenate(sides)
    free = np.setdiff1d(np.arange(count), ring)
    right = -(laplacian[free][:, ring] @ points[ring])
    points[free] = splu(laplacian[free][:, free].tocsc()).solve(right)
    return points, quads, ring, o_groups(across, up, rows) if paired else NO_GROUPS


def _least_sine(corners: np.ndarray) -> float:
    """Smallest sine of a corner's angle among quadrilaterals (Q, 4, 2); negative when folded."""
    edge = np.roll(corners, -1, axis=1) - corners
    edge /= np.maximum(np.linalg.norm(edge, axis=2, keepdims=True), 1e-300)
    before = np.roll(edge, 1, axis=1)
    return float((before[..., 0] * edge[..., 1] - before[..., 1] * edge[..., 0]).min())
