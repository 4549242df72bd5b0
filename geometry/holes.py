"""Closing the openings of a surface where there is one obvious way to."""

from __future__ import annotations

import numpy as np

from geometry.cast import open_loops
from geometry.surface import open_edges
from workbench.core.errors import DesignError

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
