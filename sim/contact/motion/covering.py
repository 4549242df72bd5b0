"""Which part of the undeformed skin a path covers, and whether a trajectory makes sense on it.

A trajectory begins outside the membrane and touches it somewhere. Distances are looked at in the
settled poses, at the vertices of the skin; where those say no, between them too.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from geometry.surface.surface import closest_point
from sim.contact.motion.touch import least_distance_mm
from sim.contact.objects.collider import Collider
from workbench.core.base.errors import DesignError
from workbench.core.result.results import Skin

DEEPEST_START_MM = 0.01
"""Overlap of the first pose that still counts as touching: a press begins at first touch."""
BEHIND = 0.9
"""Cosine between the way from the skin and its inward normal from which a place is inside."""
MOST_LOOKED_AT = 200
"""Poses at which the gap of a path that covers no vertex is looked for."""
ACCURACY_MM = 1e-3
"""Missing gap that is let pass."""
AT = "press.trajectory"


@dataclass(frozen=True, kw_only=True, slots=True)
class Covering:
    """What a path covers of the undeformed skin."""

    overlaps_mm: np.ndarray
    """Depth of the deepest skin vertex in the object at the start and after each frame [mm], shape
    (K + 1,)."""
    deepest_mm: float
    """Deepest overlap of all, between vertices too [mm]."""
    middle_mm: np.ndarray
    """Point of the skin in the middle of what is covered, shape (3,)."""
    face: int
    """Triangle that holds it."""


def overlaps_along(
    skin: Skin, collider: Collider, origins_mm: np.ndarray, turned: np.ndarray
) -> np.ndarray:
    """Depth of the deepest skin vertex in the object at each pose [mm], shape (P,); 0 if none."""
    return np.array(
        [
            max(0.0, -_inside(skin.points_mm, collider, origin, rotation)[1].min(initial=0.0))
            for origin, rotation in zip(origins_mm, turned, strict=True)
        ]
    )


def _inside(
    points_mm: np.ndarray, collider: Collider, origin: np.ndarray, rotation: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Indices and signed distances [mm] of the points within reach of the object."""
    body = points_mm - origin
    near = np.flatnonzero(np.einsum("nc,nc->n", body, body) < collider.reach_mm**2)
    return near, collider.distance(body[near] @ rotation)[0]


def cover(skin: Skin, collider: Collider, origins_mm: np.ndarray, turned: np.ndarray) -> Covering:
    """Check a trajectory against the undeformed skin, and find what it covers.

    Args:
        skin: Undeformed skin.
        collider: The object.
        origins_mm: Its origins at the start and after each frame, shape (K + 1, 3).
        turned: Rotations body to sensor, shape (K + 1, 3, 3).

    Raises:
        DesignError: If the path starts inside the membrane or never touches it.
    """
    _check_start(skin, collider, origins_mm[0], turned[0])
    overlaps_mm = overlaps_along(skin, collider, origins_mm, turned)
    frame = int(np.argmax(overlaps_mm))
    if overlaps_mm[frame] == 0.0:
        frame = _nearest_frame(skin, collider, origins_mm, turned)
    distance_mm = least_distance_mm(skin, collider, origins_mm[frame], turned[frame])
    if distance_mm >= 0.0:
        raise DesignError(
            f"the trajectory never touches the skin: the object comes nearest in frame {frame} of "
            f"{len(turned) - 1}, {distance_mm:.3g} mm away",
            hint="give places in mm in the frame of the sensor, where +Z points to the tip",
            at=AT,
        )
    middle_mm = _middle(skin, collider, origins_mm, turned, overlaps_mm, frame)
    points, _, faces = closest_point(skin.points_mm, skin.faces, middle_mm[None])
    return Covering(
        overlaps_mm=overlaps_mm,
        deepest_mm=-distance_mm,
        middle_mm=points[0],
        face=int(faces[0]),
    )


def _check_start(skin: Skin, collider: Collider, origin: np.ndarray, rotation: np.ndarray) -> None:
    overlap_mm = -least_distance_mm(skin, collider, origin, rotation)
    if overlap_mm <= DEEPEST_START_MM:
        points, away_mm, faces = closest_point(skin.points_mm, skin.faces, origin[None])
        corners = skin.points_mm[skin.faces[faces[0]]]
        normal = np.cross(corners[1] - corners[0], corners[2] - corners[0])
        inward_mm = -float((origin - points[0]) @ normal) / float(np.linalg.norm(normal))
        if inward_mm < BEHIND * away_mm[0] or away_mm[0] == 0.0:
            return
        overlap_mm = inward_mm
    raise DesignError(
        f"the trajectory starts inside the membrane: in row 1 the object is {overlap_mm:.2f} mm "
        "behind its skin",
        hint="begin with a row in which the object is outside, or just touches",
        at=AT,
    )


def _nearest_frame(
    skin: Skin, collider: Collider, origins_mm: np.ndarray, turned: np.ndarray
) -> int:
    """Frame in which a vertex of the skin comes nearest to the object."""
    count = len(turned)
    looked_at = np.unique(np.linspace(0, count - 1, min(count, MOST_LOOKED_AT)).astype(int))
    gaps_mm = [
        collider.distance((skin.points_mm - origins_mm[k]) @ turned[k])[0].min() for k in looked_at
    ]
    return int(looked_at[int(np.argmin(gaps_mm))])


def _middle(
    skin: Skin,
    collider: Collider,
    origins_mm: np.ndarray,
    turned: np.ndarray,
    overlaps_mm: np.ndarray,
    frame: int,
) -> np.ndarray:
    """Middle of the box of all covered vertices, else the vertex nearest to the object, (3,)."""
    covered: set[int] = set()
    for k in np.flatnonzero(overlaps_mm > 0.0):
        near, distance = _inside(skin.points_mm, collider, origins_mm[k], turned[k])
        covered.update(near[distance < 0.0].tolist())
    if covered:
        points_mm = skin.points_mm[sorted(covered)]
        return 0.5 * (points_mm.min(axis=0) + points_mm.max(axis=0))
    distance = collider.distance((skin.points_mm - origins_mm[frame]) @ turned[frame])[0]
    return skin.points_mm[int(np.argmin(distance))].astype(np.float64)


def clear_way_mm(
    skin: Skin,
    collider: Collider,
    origin_mm: np.ndarray,
    rotation: np.ndarray,
    *,
    outward: np.ndarray,
    gap_mm: float,
) -> float:
    """Least way along a direction after which the object is a gap away from the skin [mm].

    The gap at most grows by the way, so advancing by what is missing never goes too far.

    Args:
        skin: Undeformed skin; its vertices count.
        collider: The object.
        origin_mm: Its origin, shape (3,).
        rotation: Body to sensor, shape (3, 3).
        outward: Unit direction, shape (3,).
        gap_mm: Gap that is wanted.
    """
    way_mm, reach_mm = 0.0, collider.reach_mm + gap_mm
    while True:
        body = skin.points_mm - (origin_mm + way_mm * outward)
        body = body[np.einsum("nc,nc->n", body, body) < reach_mm**2]
        found_mm = float(collider.distance(body @ rotation)[0].min(initial=np.inf))
        if found_mm >= gap_mm - ACCURACY_MM:
            return way_mm
        way_mm += gap_mm - found_mm
