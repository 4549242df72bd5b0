"""Where the object goes: target on the skin, first touch, and a pose for every frame.

A press goes straight in along the inward normal, then shears and twists together at full depth,
then follows its strokes; depth 0 is first touch. A trajectory names the poses itself, and the
target is the middle of the skin that it covers. What moves in the room, object or sensor, makes no
difference to contact: all poses here are the object's in the frame of the sensor.
"""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass, field

import numpy as np

from geometry.surface.surface import closest_point
from geometry.surface.surface_place import smooth_normal
from sim.contact.motion.covering import clear_way_mm, cover, overlaps_along
from sim.contact.motion.path import Leg, State, Track, current, legs_of, straight_counts, track_of
from sim.contact.motion.touch import first_touch
from sim.contact.objects.collider import Collider
from workbench.core.base.errors import DesignError
from workbench.core.base.frames import tangent
from workbench.core.base.poses import composed, pose_rows, sensor_poses
from workbench.core.base.units import radians
from workbench.core.press.motion import Mover
from workbench.core.press.press import Press
from workbench.core.press.trajectory import Trajectory
from workbench.core.result.results import Skin

FARTHEST_TARGET_MM = 5.0
"""Largest distance of a target from the skin."""
SHALLOW_MM = 1e-3
"""Depth up to which a frame may have no reaction."""
WAYPOINTS = 8
"""Pieces of a frame whose ways are added up where the path may bend within it."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Approach:
    """The object and its path in the sensor frame."""

    collider: Collider
    target_mm: np.ndarray
    """Target on the skin [mm], shape (3,): the middle of the active region."""
    normal: np.ndarray
    """Outward unit normal there, shape (3,)."""
    tangent_u: np.ndarray
    """Unit U: +Z projected on the tangent plane, or +X where the normal is parallel to +Z."""
    tangent_v: np.ndarray
    """Unit V = n x U."""
    touch_mm: float
    """Height of the body origin above the target at first touch [mm]."""
    press: Press
    legs: tuple[Leg, ...] = ()
    """The strokes of the press."""
    track: Track | None = None
    """The trajectory, which then is the whole path."""
    overlaps_mm: np.ndarray = field(default_factory=lambda: np.zeros(0))
    """Overlap of object and undeformed skin at the start and after each frame [mm], shape
    (K + 1,); with strokes or a trajectory only."""
    counts: np.ndarray = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    """What `continues` answers for each frame, shape (K,); with strokes or a trajectory only."""
    covered_mm: tuple[float, float] = (0.0, 0.0)
    """Deepest overlap and farthest way aside of a trajectory [mm]."""

    def pose(self, progress: float) -> tuple[np.ndarray, np.ndarray]:
        """Origin [mm], (3,), and rotation body to sensor, (3, 3), after `progress` frames."""
        if self.track is not None:
            origins, turned = self.track.poses(np.array([progress]))
            return origins[0], turned[0]
        if self.legs and progress >= self.legs[0].first:
            return self.placed(current(self.legs, progress).at(progress))
        origins, turned = self._straight(np.array([progress]))
        return origins[0], turned[0]

    def poses(self, progress: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Origins [mm], (P, 3), and rotations body to sensor, (P, 3, 3), at progress (P,)."""
        progress = np.asarray(progress, dtype=np.float64)
        if self.track is not None:
            return self.track.poses(progress)
        if not self.legs or progress.max() < self.legs[0].first:
            return self._straight(progress)
        origins, turned = zip(*[self.pose(float(step)) for step in progress], strict=True)
        return np.stack(origins), np.stack(turned)

    def _straight(self, progress: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """`poses` before the first stroke: straight in, then aside and around."""
        frames = self.press.frames
        inward = np.minimum(progress / frames, 1.0)[:, None]
        aside = np.clip(progress / frames - 1.0, 0.0, 1.0)[:, None]
        shear_u, shear_v = self.press.shear_mm
        origins = self.target_mm + (self.touch_mm - inward * self.press.depth_mm) * self.normal
        origins = origins + aside * (shear_u * self.tangent_u + shear_v * self.tangent_v)
        angles = aside * radians(self.press.twist_deg)
        turned = np.empty((len(progress), 3, 3))
        turned[:, :, 0] = np.cos(angles) * self.tangent_u + np.sin(angles) * self.tangent_v
        turned[:, :, 1] = np.cos(angles) * self.tangent_v - np.sin(angles) * self.tangent_u
        turned[:, :, 2] = self.normal
        return origins, turned

    def placed(self, state: State) -> tuple[np.ndarray, np.ndarray]:
        """Origin [mm], (3,), and rotation body to sensor, (3, 3), of a state of a leg."""
        u_mm, v_mm = state.aside_mm
        origin = self.target_mm + (self.touch_mm - state.depth_mm) * self.normal
        origin = origin + u_mm * self.tangent_u + v_mm * self.tangent_v
        frame = np.stack([self.tangent_u, self.tangent_v, self.normal], axis=1)
        return origin, frame @ state.rotation

    def sensor_poses(self) -> np.ndarray:
        """Poses of a moving sensor in the room, (K, 7), frame by frame; (0, 7) if it rests."""
        if self.press.mover is Mover.OBJECT:
            return np.zeros((0, 7))
        seen = pose_rows(*self.poses(np.arange(self.frame_count + 1.0)))
        first = np.array([0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0])
        if self.press.trajectory is not None:
            first = np.array(self.press.trajectory.poses[0])
        return sensor_poses(seen, first)[1:]

    @property
    def frame_count(self) -> int:
        """Frames of object and actuators together."""
        return self.press.frame_count

    @property
    def deepest_mm(self) -> float:
        """Largest depth on the path [mm]: along the inward normal, or a trajectory's overlap."""
        if self.track is not None:
            return self.covered_mm[0]
        ends = (leg.at(math.inf).depth_mm for leg in self.legs)
        return max((self.press.depth_mm, *ends))

    @property
    def aside_mm(self) -> float:
        """Largest shift in the tangent plane on the path [mm]."""
        if self.track is not None:
            return self.covered_mm[1]
        ends = (math.hypot(*leg.at(math.inf).aside_mm) for leg in self.legs)
        return max((math.hypot(*self.press.shear_mm), *ends))

    def travel_mm(self, frame: int, arm_mm: float) -> float:
        """Farthest way of a point of the object, `arm_mm` from its origin, within a frame [mm]."""
        bends = self.press.trajectory is not None and self.press.trajectory.every_s > 0.0
        pieces = WAYPOINTS if bends else 1
        origins, turned = self.poses(frame + np.arange(pieces + 1) / pieces)
        ways_mm = np.linalg.norm(np.diff(origins, axis=0), axis=1)
        spin = 0.5 * (np.einsum("pij,pij->p", turned[:-1], turned[1:]) - 1.0)
        angles = np.arccos(np.clip(spin, -1.0, 1.0))
        return float((ways_mm + arm_mm * angles).sum())

    def continues(self, frame: int) -> int:
        """Frames up to and including this one that go straight on at one velocity.

        0 at rest; a frame in which the direction changes, or in which contact with the undeformed
        skin begins or ends, has 1.
        """
        if len(self.counts):
            return int(self.counts[frame])
        press = self.press
        moves = press.depth_mm > 0.0 if frame < press.frames else frame < press.approach_frames
        return frame % press.frames + 1 if moves else 0

    def depth_mm(self, frame: int) -> float:
        """Depth at the end of a frame [mm]: from first touch, or of the undeformed skin inside."""
        if len(self.overlaps_mm):
            return float(self.overlaps_mm[frame + 1])
        return self.press.depth_mm * min(1.0, (frame + 1) / self.press.frames)

    def pressing(self, frame: int) -> bool:
        """Whether a contact force is certainly due: the undeformed skin would be in the object.

        Nothing is certain while regions are driven, which may take the skin away, and after the
        approach of a press without strokes, whose shear may leave the skin.
        """
        if self.press.actuations:
            return False
        if not len(self.overlaps_mm) and frame >= self.press.frames:
            return False
        return self.depth_mm(frame) > SHALLOW_MM


def expect_near(press: Press, nearest_mm: np.ndarray, distance_mm: float) -> None:
    """Refuse a target that is not near the skin.

    Raises:
        DesignError: With the distance, the limit and the nearest point of the skin [mm].
    """
    if distance_mm <= FARTHEST_TARGET_MM:
        return
    # Adding zero turns the minus zero of a rounded coordinate into zero.
    nearest = ", ".join(f"{x:.1f}" for x in np.round(nearest_mm, 1) + 0.0)
    raise DesignError(
        f"target {tuple(press.target_mm)} mm is {distance_mm:.1f} mm from the skin; "
        f"the limit is {FARTHEST_TARGET_MM:g} mm",
        hint=f"the nearest point of the skin is ({nearest}) mm",
        at="press.target_mm",
    )


def plan_approach(skin: Skin, collider: Collider, press: Press) -> Approach:
    """Find the target on the outer skin, the first touch, and the whole path.

    Raises:
        DesignError: If the target is more than 5 mm from the skin, the indenter misses the skin
            there or meets it elsewhere first, or a trajectory starts inside the membrane or never
            touches it.
        SolveError: If the first touch cannot be found.
    """
    if press.trajectory is not None:
        return _plan_trajectory(skin, collider, press, press.trajectory)
    straight = _plan_straight(skin, collider, press)
    if not press.strokes:
        return straight

    def clear_depth_mm(state: State, gap_mm: float) -> float:
        origin, rotation = straight.placed(state)
        outward = straight.normal
        way_mm = clear_way_mm(skin, collider, origin, rotation, outward=outward, gap_mm=gap_mm)
        return state.depth_mm - way_mm

    legs = legs_of(press, straight.touch_mm, clear_depth_mm)
    path = dataclasses.replace(straight, legs=legs)
    origins, turned = path.poses(np.arange(path.frame_count + 1.0))
    overlaps_mm = overlaps_along(skin, collider, origins, turned)
    counts = straight_counts(origins, turned, overlaps_mm, collider.reach_mm)
    return dataclasses.replace(path, overlaps_mm=overlaps_mm, counts=counts)


def _plan_trajectory(
    skin: Skin, collider: Collider, press: Press, trajectory: Trajectory
) -> Approach:
    standing = None
    if press.object_pose is not None:
        standing = np.array(press.object_pose)
    elif press.mover is Mover.SENSOR:
        origin, rotation = _plan_straight(skin, collider, press).pose(0.0)
        seen = pose_rows(origin[None], rotation[None])
        standing = composed(np.array(trajectory.poses[:1]), seen)[0]
    track = track_of(trajectory, standing)
    origins, turned = track.poses(np.arange(press.frame_count + 1.0))
    covering = cover(skin, collider, origins, turned)
    target = covering.middle_mm
    normal = smooth_normal(skin, covering.face, target)
    tangent_u = tangent(normal)
    first = int(np.argmax(covering.overlaps_mm > 0.0))
    ways_mm = origins[first:] - origins[first]
    ways_mm -= np.outer(ways_mm @ normal, normal)
    touching = covering.overlaps_mm[first:] > 0.0
    aside_mm = float(np.linalg.norm(ways_mm[touching], axis=1).max(initial=0.0))
    return Approach(
        collider=collider,
        target_mm=target,
        normal=normal,
        tangent_u=tangent_u,
        tangent_v=np.cross(normal, tangent_u),
        touch_mm=float((origins[first] - target) @ normal),
        press=press,
        track=track,
        overlaps_mm=covering.overlaps_mm,
        counts=straight_counts(origins, turned, covering.overlaps_mm, collider.reach_mm),
        covered_mm=(covering.deepest_mm, aside_mm),
    )


def _plan_straight(skin: Skin, collider: Collider, press: Press) -> Approach:
    """Project the target on the outer skin and find the first touch."""
    query = np.array([press.target_mm], dtype=np.float64)
    points, distances, faces = closest_point(skin.points_mm, skin.faces, query)
    expect_near(press, points[0], float(distances[0]))
    target = points[0]
    normal = smooth_normal(skin, int(faces[0]), target)
    tangent_u = tangent(normal)
    tangent_v = np.cross(normal, tangent_u)
    rotation = np.stack([tangent_u, tangent_v, normal], axis=1)
    touch_mm = first_touch(skin, collider, target, rotation)
    return Approach(
        collider=collider,
        target_mm=target,
        normal=normal,
        tangent_u=tangent_u,
        tangent_v=tangent_v,
        touch_mm=touch_mm,
        press=press,
    )
