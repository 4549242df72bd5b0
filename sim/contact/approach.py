"""Where the indenter goes: target on the skin, first touch, and a pose for every frame.

The path is straight in along the inward normal, then shear and twist together at full depth.
Depth 0 is first touch along that line, found by conservative advancement: a body whose nearest
skin point is d away can move by d and not pass it (Mirtich, 1996). The triangles that can touch
first are subdivided, so the answer does not depend on where vertices happen to lie.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from geometry.surface import closest_point
from sim.contact.collider import Collider
from workbench.core.errors import DesignError, SolveError
from workbench.core.frames import tangent
from workbench.core.press import Press
from workbench.core.results import Skin
from workbench.core.units import radians

FARTHEST_TARGET_MM = 5.0
"""Largest distance of a target from the skin."""
TOUCH_MM = 1e-5
"""Gap that counts as touching."""
FINEST_EDGE_MM = 0.02
"""Triangles are subdivided to this edge; a 3 mm sphere then touches within 1e-4 mm."""
MOST_ADVANCES = 500
FARTHEST_TOUCH_MM = 3.0
"""Largest distance of the first touch from the target, beyond the reach of the indenter."""
MOST_TRIANGLES = 4096
"""Triangles kept at each subdivision; more only tie, as on a flat skin."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Approach:
    """A press path in the sensor frame."""

    target_mm: np.ndarray
    """Target on the skin [mm], shape (3,)."""
    normal: np.ndarray
    """Outward unit normal there, shape (3,)."""
    tangent_u: np.ndarray
    """Unit U: +Z projected on the tangent plane, or +X where the normal is parallel to +Z."""
    tangent_v: np.ndarray
    """Unit V = n x U."""
    touch_mm: float
    """Height of the body origin above the target at first touch [mm]."""
    press: Press

    def pose(self, progress: float) -> tuple[np.ndarray, np.ndarray]:
        """Origin [mm], (3,), and rotation body to sensor, (3, 3), after `progress` frames."""
        frames = self.press.frames
        inward = min(progress / frames, 1.0)
        aside = max(progress / frames - 1.0, 0.0)
        shear_u, shear_v = self.press.shear_mm
        origin = self.target_mm + (self.touch_mm - inward * self.press.depth_mm) * self.normal
        origin = origin + aside * (shear_u * self.tangent_u + shear_v * self.tangent_v)
        angle = radians(aside * self.press.twist_deg)
        along = math.cos(angle) * self.tangent_u + math.sin(angle) * self.tangent_v
        across = math.cos(angle) * self.tangent_v - math.sin(angle) * self.tangent_u
        return origin, np.stack([along, across, self.normal], axis=1)

    @property
    def frame_count(self) -> int:
        """Frames of object and actuators together."""
        return self.press.frame_count

    @property
    def deepest_mm(self) -> float:
        """Largest depth along the inward normal on the path [mm]."""
        return self.press.depth_mm

    @property
    def aside_mm(self) -> float:
        """Largest shift in the tangent plane on the path [mm]."""
        return math.hypot(*self.press.shear_mm)

    def travel_mm(self, frame: int, arm_mm: float) -> float:
        """Farthest way of a point of the object, `arm_mm` from its origin, within a frame [mm]."""
        (start, turned), (end, turned_on) = self.pose(frame), self.pose(frame + 1.0)
        spin = 0.5 * (np.trace(turned.T @ turned_on) - 1.0)
        angle = math.acos(min(1.0, max(-1.0, spin)))
        return float(np.linalg.norm(end - start)) + arm_mm * angle

    def continues(self, frame: int) -> int:
        """Frames up to and including this one that go straight on at one speed, 0 at rest."""
        frames = self.press.frames
        return frame % frames + 1 if frame < 2 * frames else 0


def plan_approach(skin: Skin, collider: Collider, press: Press) -> Approach:
    """Project the target on the outer skin and find the first touch.

    Raises:
        DesignError: If the target is more than 5 mm from the skin, or the indenter misses the skin
            there or meets it elsewhere first.
        SolveError: If the first touch cannot be found.
    """
    query = np.array([press.target_mm], dtype=np.float64)
    points, distances, faces = closest_point(skin.points_mm, skin.faces, query)
    if distances[0] > FARTHEST_TARGET_MM:
        # Adding zero turns the minus zero of a rounded coordinate into zero.
        nearest = ", ".join(f"{x:.1f}" for x in np.round(points[0], 1) + 0.0)
        raise DesignError(
            f"target {tuple(press.target_mm)} mm is {distances[0]:.1f} mm from the skin; "
            f"the limit is {FARTHEST_TARGET_MM:g} mm",
            hint=f"the nearest point of the skin is ({nearest}) mm",
            at="press.target_mm",
        )
    target = points[0]
    normal = smooth_normal(skin, int(faces[0]), target)
    tangent_u = tangent(normal)
    tangent_v = np.cross(normal, tangent_u)
    rotation = np.stack([tangent_u, tangent_v, normal], axis=1)
    touch_mm = first_touch(skin, collider, target, rotation)
    return Approach(
        target_mm=target,
        normal=normal,
        tangent_u=tangent_u,
        tangent_v=tangent_v,
        touch_mm=touch_mm,
        press=press,
    )


def smooth_normal(skin: Skin, face: int, point: np.ndarray) -> np.ndarray:
    """Unit vertex normal interpolated at a point of a triangle, shape (3,)."""
    corners = skin.points_mm[skin.faces[face]]
    shares, *_ = np.linalg.lstsq(
        np.vstack([corners.T, np.ones(3)]), np.append(point, 1.0), rcond=None
    )
    normal = np.clip(shares, 0.0, 1.0) @ skin.normals[skin.faces[face]]
    return normal / np.linalg.norm(normal)


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
    for _ in range(MOST_ADVANCES):
        gap = float(collider.distance(points - [0.0, 0.0, height])[0].min())
        height -= gap
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
