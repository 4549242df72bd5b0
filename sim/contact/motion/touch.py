"""Where a body first touches the skin along a line, and how deep a pose lies in it.

First touch is found by conservative advancement: a body whose nearest skin point is d away can move
by d and not pass it (Mirtich, 1996). The triangles that can touch first are subdivided, so the
answer does not depend on where vertices happen to lie. The same search gives the least distance of
a skin from a body at rest.
"""

from __future__ import annotations

import numpy as np

from sim.contact.objects.collider import Collider
from workbench.core.base.errors import DesignError, SolveError
from workbench.core.result.results import Skin

TOUCH_MM = 1e-5
"""Gap that counts as touching."""
FINEST_EDGE_MM = 0.02
"""Triangles are subdivided to this edge; a 3 mm sphere then touches within 1e-4 mm."""
MOST_ADVANCES = 500
FARTHEST_TOUCH_MM = 3.0
"""Largest distance of the first touch from the target, beyond the reach of the indenter."""
MOST_ASKED = 2048
"""Points whose distance is asked for at once."""
STEEPEST = 1.1
"""Slope that a sampled distance may have; an exact one has 1."""
MOST_TRIANGLES = 4096
"""Triangles kept at each subdivision; more only tie, as on a flat skin."""


def first_touch(skin: Skin, collider: Collider, target: np.ndarray, rotation: np.ndarray) -> float:
    """Height of the body origin over the target at which it first touches the skin [mm].

    Args:
        skin: Undeformed skin.
        collider: The indenter.
        target: Point the body's -Z axis passes through [mm], shape (3,).
        rotation: Body to sensor, shape (3, 3); the body moves along its -Z.

    Raises:
        DesignError: If it misses the skin, or meets it far from the target.
        SolveError: If the advance does not end.
    """
    corners = (skin.points_mm[skin.faces] - target) @ rotation
    lateral = np.linalg.norm(corners[:, :, :2], axis=2).min(axis=1)
    edge = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2).max()
    corners = corners[lateral < collider.reach_mm + edge]
    if not len(corners):
        raise _missed(0.0)
    start = float(corners[:, :, 2].max()) + collider.reach_mm + 1.0
    while True:
        height = _advance(corners.reshape(-1, 3), collider, start)
        centre = corners.mean(axis=1)
        radius = np.linalg.norm(corners - centre[:, None], axis=2).max(axis=1)
        slack = collider.distance(centre - [0.0, 0.0, height])[0] - radius
        if radius.max() < FINEST_EDGE_MM:
            _check_near_target(centre[np.argmin(slack)], collider)
            return height
        nearest = np.argsort(slack, kind="stable")[:MOST_TRIANGLES]
        corners = _subdivide(corners[nearest[slack[nearest] <= TOUCH_MM]])


def _advance(points: np.ndarray, collider: Collider, start: float) -> float:
    height, below = start, float(points[:, 2].min()) - collider.reach_mm
    # Points that were far are not asked again before the body can have come near them.
    at_least = np.full(len(points), -np.inf)
    for _ in range(MOST_ADVANCES):
        gap, asked = np.inf, np.zeros(len(points), bool)
        while len(near := np.flatnonzero(~asked & (at_least < gap))):
            # A few that may be nearest first: their gap leaves out most of the others.
            if len(near) > MOST_ASKED:
                near = near[np.argpartition(at_least[near], MOST_ASKED)[:MOST_ASKED]]
            at_least[near] = collider.distance(points[near] - [0.0, 0.0, height])[0]
            asked[near] = True
            gap = min(gap, float(at_least[near].min()))
        height -= gap
        at_least -= STEEPEST * max(gap, 0.0)
        if gap < TOUCH_MM:
            return height
        if height < below:
            raise _missed(start - below)
    raise SolveError(
        f"the indenter is still {gap:.1e} mm from the skin after {MOST_ADVANCES} advances; "
        f"{TOUCH_MM:g} mm counts as touching",
        hint="move press.target_mm a little: the indenter grazes the skin",
        at="press.target_mm",
    )


def _missed(travel_mm: float) -> DesignError:
    return DesignError(
        f"the indenter passes beside the skin: no touch within {travel_mm:.1f} mm of travel",
        hint="move press.target_mm to where the object meets the skin, or centre its mesh",
        at="press.target_mm",
    )


def _check_near_target(touch: np.ndarray, collider: Collider) -> None:
    """Refuse a first touch [mm from the target], shape (3,), that is not about the target."""
    away_mm, limit_mm = float(np.linalg.norm(touch)), collider.reach_mm + FARTHEST_TOUCH_MM
    if away_mm > limit_mm:
        raise DesignError(
            f"the object meets the skin elsewhere first, {away_mm:.1f} mm from the target; "
            f"the limit is {limit_mm:.1f} mm",
            hint="move press.target_mm to that place or press with a smaller object",
            at="press.target_mm",
        )


def _subdivide(corners: np.ndarray) -> np.ndarray:
    """Each triangle as four, by the midpoints of its edges."""
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    ab, bc, ca = (a + b) / 2, (b + c) / 2, (c + a) / 2
    pieces = [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
    return np.concatenate([np.stack(piece, axis=1) for piece in pieces])


def least_distance_mm(
    skin: Skin, collider: Collider, origin_mm: np.ndarray, rotation: np.ndarray
) -> float:
    """Least signed distance [mm] of the undeformed skin from a body at rest; inside is negative.

    Branch and bound over triangles, with the bound that a distance changes by at most the way:
    accurate to `FINEST_EDGE_MM` squared over the body's curvature where the body is smooth.

    Args:
        skin: Undeformed skin.
        collider: The body.
        origin_mm: Its origin, shape (3,).
        rotation: Body to sensor, shape (3, 3).
    """
    points = (skin.points_mm - origin_mm) @ rotation
    best = float(collider.distance(points)[0].min())
    corners = points[skin.faces]
    while True:
        centre = corners.mean(axis=1)
        radius = np.linalg.norm(corners - centre[:, None], axis=2).max(axis=1)
        value = collider.distance(centre)[0]
        best = min(best, float(value.min()))
        open_still = (value - radius < best - TOUCH_MM) & (radius >= FINEST_EDGE_MM)
        if not open_still.any():
            return best
        nearest = np.flatnonzero(open_still)
        nearest = nearest[np.argsort((value - radius)[nearest], kind="stable")[:MOST_TRIANGLES]]
        corners = _subdivide(corners[nearest])
