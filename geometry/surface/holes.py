"""Closing the openings of a surface where there is one obvious way to."""

from __future__ import annotations

import numpy as np

from geometry.surface.surface import is_watertight, open_edges
from workbench.core.base.errors import DesignError, GeometryError

FLAT_SHARE = 1e-3
"""Height of an opening over its width below which it is flat."""
SMALL_SHARE = 0.05
"""Width of a hole over that of the body below which it may be closed by a fan."""


class Damaged(DesignError):
    """What is wrong with a surface that a remesh may cure; never leaves the reading of a file."""


def close_holes(
    points_mm: np.ndarray, faces: np.ndarray, name: str, notes: list[str]
) -> tuple[np.ndarray, np.ndarray]:
    """The surface with flat openings capped and small holes closed; says so in `notes`.

    Raises:
        Damaged: If an opening is neither flat nor small, or the surface does not close.
    """
    if not open_edges(faces):
        return points_mm, faces
    size = float(np.ptp(points_mm, axis=0).max())
    for loop in open_loops(faces):
        # Stray triangles on an edge leave chains that enclose nothing; they are counted below.
        if len(loop) < 3:
            continue
        rim = points_mm[loop]
        width = float(np.ptp(rim, axis=0).max())
        centre, axes = _plane(rim)
        flat = float(np.abs((rim - centre) @ axes[2]).max()) <= FLAT_SHARE * max(width, 1e-12)
        place = "({:.3g}, {:.3g}, {:.3g})".format(*centre)
        if flat:
            lid = _flat_lid(rim, centre, axes)
            faces = np.vstack([faces, loop[::-1][lid]])
            notes.append(f"a flat opening {width:.3g} wide at {place} was capped")
        elif width <= SMALL_SHARE * size:
            following = np.roll(loop, -1)
            fan = np.column_stack([following, loop, np.full(len(loop), len(points_mm))])
            points_mm, faces = np.vstack([points_mm, centre]), np.vstack([faces, fan])
            notes.append(f"a hole {width:.3g} wide at {place} was closed")
        else:
            raise Damaged(
                f"{name} is open: a hole {width:.3g} wide at {place}, larger than "
                f"{100 * SMALL_SHARE:g} % of the body",
                hint="close it in the program that made it",
            )
    left = open_edges(faces)
    if left:
        raise Damaged(
            f"{name} is open: {left} edges have no partner, and faces may be missing or doubled",
            hint="repair it in the program that made it",
        )
    return points_mm, faces


def _plane(rim: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Centre of a rim and its principal axes, shape (3, 3), the flattest last, right-handed."""
    centre = rim.mean(axis=0)
    axes = np.linalg.svd(rim - centre, full_matrices=True)[2]
    if np.linalg.det(axes) < 0.0:
        axes[2] = -axes[2]
    return centre, axes


def _flat_lid(rim: np.ndarray, centre: np.ndarray, axes: np.ndarray) -> np.ndarray:
    """Triangles over the reversed rim that close it, as indices into it, shape (T, 3)."""
    import manifold3d

    outline = ((rim - centre) @ axes[:2].T)[::-1]
    x, y = outline.T
    if x @ np.roll(y, -1) < y @ np.roll(x, -1):
        # Seen from the other side the outline runs the way the triangulation wants it.
        outline = outline * [1.0, -1.0]
    return np.asarray(manifold3d.triangulate([outline.tolist()]))


def open_loops(faces: np.ndarray) -> list[np.ndarray]:
    """Closed chains of vertices along the open edges of a surface, in the faces' direction."""
    ends = np.asarray(faces, dtype=np.int64)
    start, stop = ends.ravel(), np.roll(ends, -1, axis=1).ravel()
    span = int(ends.max()) + 1
    lonely = ~np.isin(start * span + stop, stop * span + start)
    following = dict(zip(start[lonely].tolist(), stop[lonely].tolist(), strict=True))
    loops = []
    while following:
        first, here = following.popitem()
        loop = [first]
        while here != first and here in following:
            loop.append(here)
            here = following.pop(here)
        loops.append(np.array(loop))
    return loops


def cap(points_mm: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Triangles that close a surface that is open downward, shape (M, 3).

    They look up, and with the inner face of a membrane make its core turned inside out.

    Raises:
        GeometryError: If the surface has no open rim or is not closed by it.
    """
    import manifold3d

    loops = open_loops(faces)
    if not loops:
        raise _uncapped("has no open rim")
    # Against the surface's own direction, which makes outlines of caps that look up run
    # counter-clockwise and those of holes clockwise, as the triangulation wants them.
    turned = [loop[::-1] for loop in loops]
    triangles = manifold3d.triangulate([points_mm[loop, :2].tolist() for loop in turned])
    lid = np.concatenate(turned)[np.asarray(triangles)]
    if not is_watertight(np.vstack([faces, lid])):
        raise _uncapped(f"is not closed by caps on its {len(loops)} rims")
    return lid


def _uncapped(reason: str) -> GeometryError:
    return GeometryError(
        f"the membrane's inner face {reason}, so no core can be made",
        hint="the inner face must be open at the base plane; look at the labels of the body",
        at="shape",
    )
