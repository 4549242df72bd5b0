"""Which side of an object is meant to touch: a foot is flat, what it carries is not.

Each of the six sides of a body is seen along its axis, as a map of how deep it lies behind its own
foremost plane. A side is flat where half of what is seen lies in that plane; the side across is
structured if less than `STRUCTURED_SHARE` of that does. With a foot down its far side was meant.
Lying on a side that is flat in part and recessed in part, the structured side was meant too, if
there is one across from a flat one: so a head on a foot lies, and no prism.
Left out: features that are cut into a foot without taking a quarter of it away.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from geometry.surface.rays import RayCaster

RAYS = 96
"""Rays along each edge of the box of what is seen: 0.2 mm on an object of 20 mm."""
FLAT_MM, FLAT_WIDTHS = 0.1, 0.02
"""Depth up to which a place lies in the foremost plane: the smaller of this and of a share of the
width."""
FLAT_SHARE = 0.5
"""A foot with a socket of 10 mm in 16 mm has 0.61."""
STRUCTURED_SHARE = 0.75
RECESS_WIDTHS, RECESS_SHARE = 0.1, 0.1
"""Depth over the width beyond any rounding, and the share of a side that lies as deep."""
UP = 0.5
"""Cosine to +Z from which a face looks up."""


class Side(NamedTuple):
    """One side of a body."""

    normal: np.ndarray
    """Outward unit normal, shape (3,)."""
    flat: float
    """Share of what is seen that lies in the foremost plane, in [0, 1]."""
    recessed: float
    """Share that lies deeper than any rounding, in [0, 1]."""


def meant_side(points_mm: np.ndarray, faces: np.ndarray) -> np.ndarray | None:
    """Outward normal of the side that was meant to touch in place of -Z; None if -Z is fine.

    Args:
        points_mm: Vertices of a closed body, shape (N, 3).
        faces: Triangles, shape (M, 3).
    """
    caster = RayCaster(points_mm, faces)
    low, high = points_mm.min(axis=0), points_mm.max(axis=0)
    below, above = (_side(caster, low, high, 2, sign) for sign in (-1.0, 1.0))
    if below.flat < FLAT_SHARE:
        return None
    if _structured(above, foot=below):
        return above.normal
    if below.recessed < RECESS_SHARE:
        return None
    found = None
    for axis in (0, 1):
        pair = [_side(caster, low, high, axis, sign) for sign in (-1.0, 1.0)]
        for side, across in (pair, pair[::-1]):
            if across.flat >= FLAT_SHARE and _structured(side, foot=across):
                found = side if found is None or side.flat < found.flat else found
    return None if found is None else found.normal


def _structured(side: Side, *, foot: Side) -> bool:
    return side.flat <= STRUCTURED_SHARE * foot.flat


def _side(caster: RayCaster, low: np.ndarray, high: np.ndarray, axis: int, sign: float) -> Side:
    """The side that looks along one axis, by rays from outside."""
    across = [k for k in range(3) if k != axis]
    share = (np.arange(RAYS) + 0.5) / RAYS
    lines = [low[k] + (high[k] - low[k]) * share for k in across]
    origins = np.zeros((RAYS**2, 3))
    origins[:, across] = np.stack(np.meshgrid(*lines, indexing="ij"), axis=-1).reshape(-1, 2)
    width_mm = float((high - low).max())
    normal = np.zeros(3)
    normal[axis] = sign
    origins[:, axis] = (high if sign > 0.0 else low)[axis] + sign * width_mm
    distance, face, _ = caster.hits(origins, np.tile(-normal, (len(origins), 1)))
    depth_mm = distance[face >= 0] - width_mm
    if not len(depth_mm):
        return Side(normal, 0.0, 0.0)
    flat = depth_mm < min(FLAT_MM, FLAT_WIDTHS * width_mm)
    recessed = depth_mm > RECESS_WIDTHS * width_mm
    return Side(normal, float(flat.mean()), float(recessed.mean()))


def touching_patch(
    points_mm: np.ndarray, faces: np.ndarray, deep_mm: float
) -> tuple[np.ndarray, np.ndarray]:
    """The lowest part of a surface, up to a height above its lowest point.

    What looks up is left out; walls belong to it, so that it is seen from aside too.

    Args:
        points_mm: Vertices, shape (N, 3).
        faces: Triangles counter-clockwise from outside, shape (M, 3).
        deep_mm: The height.

    Returns:
        Vertices [mm], shape (P, 3), and triangles, shape (Q, 3), cut at that height.
    """
    from geometry.surface.section import Plane, half_space_clip

    corners = points_mm[faces]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    lowest_mm = float(points_mm[:, 2].min())
    looks_up = normal[:, 2] > UP * np.linalg.norm(normal, axis=1)
    near = ~looks_up & (corners[:, :, 2].min(axis=1) < lowest_mm + deep_mm)
    plane = Plane((0.0, 0.0, lowest_mm + deep_mm), (0.0, 0.0, 1.0))
    found = half_space_clip(points_mm, faces[near], plane)
    return found.points_mm, found.faces
