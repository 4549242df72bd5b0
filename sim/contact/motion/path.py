"""The path of the object's pose: the strokes of a press as legs, or the rows of a trajectory.

A leg is a straight move and a turn at constant speed in the frame (U, V, n) of the target; its
state is depth, place aside and rotation. A roll by an angle phi about the unit axis a moves the
origin by h phi (a x n), h the height of the origin above the contact plane at its start: then the
point of the body h below the origin, moving with (h a x n) phi' + phi' a x (-h n) = 0, stands
still. A release goes outward until the undeformed skin is clear.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from workbench.core.base.frames import quaternion
from workbench.core.base.poses import rotations
from workbench.core.base.units import radians
from workbench.core.press.motion import Stroke, StrokeKind
from workbench.core.press.press import Press
from workbench.core.press.trajectory import Trajectory, poses_at

SAME_STEP = 0.1
"""Relative change of a step that still counts as going straight on."""
AT_REST_MM = 1e-9


@dataclass(frozen=True, kw_only=True, slots=True)
class State:
    """Where the body is in the frame of the target."""

    depth_mm: float
    """Way of the origin inward from first touch [mm]."""
    aside_mm: np.ndarray
    """Way of the origin along U and V [mm], shape (2,)."""
    rotation: np.ndarray
    """Body to (U, V, n), shape (3, 3)."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Leg:
    """A stroke with the state it starts from."""

    first: float
    """Progress [frames] at its start."""
    frames: int
    start: State
    deeper_mm: float
    aside_mm: np.ndarray
    """Way along U and V [mm], shape (2,)."""
    axis: np.ndarray
    """Unit axis of the turn in (U, V, n), shape (3,)."""
    turn_deg: float

    def at(self, progress: float) -> State:
        """State at a progress, held before the start and after the end."""
        share = min(max((progress - self.first) / self.frames, 0.0), 1.0)
        turned = turn(self.axis, radians(share * self.turn_deg)) @ self.start.rotation
        return State(
            depth_mm=self.start.depth_mm + share * self.deeper_mm,
            aside_mm=self.start.aside_mm + share * self.aside_mm,
            rotation=turned,
        )


def turn(axis: np.ndarray, angle_rad: float) -> np.ndarray:
    """Rotation about a unit axis, shape (3, 3): Rodrigues' formula."""
    x, y, z = axis
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.eye(3) + math.sin(angle_rad) * cross + (1.0 - math.cos(angle_rad)) * cross @ cross


def after_approach(press: Press) -> State:
    """State after approach, shear and twist."""
    up = np.array([0.0, 0.0, 1.0])
    return State(
        depth_mm=press.depth_mm,
        aside_mm=np.array(press.shear_mm, dtype=np.float64),
        rotation=turn(up, radians(press.twist_deg)),
    )


def legs_of(
    press: Press, touch_mm: float, clear_depth_mm: Callable[[State, float], float]
) -> tuple[Leg, ...]:
    """The strokes of a press as legs.

    Args:
        press: The press.
        touch_mm: Height of the body's origin over the contact plane at first touch [mm].
        clear_depth_mm: Largest depth, at most that of the given state, at which the object leaves
            the given gap [mm] to the skin.
    """
    state, first = after_approach(press), float(press.approach_frames)
    legs: list[Leg] = []
    for stroke in press.strokes:
        deeper_mm = -stroke.shift_mm[2]
        if stroke.kind is StrokeKind.RELEASE:
            deeper_mm = clear_depth_mm(state, stroke.clearance_mm) - state.depth_mm
        axis = _axis(stroke)
        aside_mm = np.array(stroke.shift_mm[:2])
        if stroke.kind is StrokeKind.ROLL:
            height_mm = touch_mm - state.depth_mm
            way = np.cross(axis, [0.0, 0.0, 1.0])[:2]
            aside_mm = height_mm * radians(stroke.turn_deg) * way
        leg = Leg(
            first=first,
            frames=stroke.frames,
            start=state,
            deeper_mm=deeper_mm,
            aside_mm=aside_mm,
            axis=axis,
            turn_deg=stroke.turn_deg,
        )
        legs.append(leg)
        state, first = leg.at(math.inf), first + stroke.frames
    return tuple(legs)


def _axis(stroke: Stroke) -> np.ndarray:
    if stroke.kind is StrokeKind.ROLL:
        angle = radians(stroke.axis_deg)
        return np.array([math.cos(angle), math.sin(angle), 0.0])
    return np.array([0.0, 0.0, 1.0])


def current(legs: Sequence[Leg], progress: float) -> Leg:
    """The leg that a progress at or after the first one's start lies in."""
    for leg in reversed(legs):
        if progress >= leg.first:
            return leg
    return legs[0]


@dataclass(frozen=True, kw_only=True, slots=True)
class Track:
    """A trajectory as the contact sees it: the object in the frame of the sensor."""

    times_s: np.ndarray
    """Time of each row [s], shape (R,)."""
    rows: np.ndarray
    """Poses of what moves, shape (R, 7)."""
    frame_times_s: np.ndarray
    """Time of the start and of every frame [s], shape (K + 1,)."""
    object_pose: np.ndarray | None
    """The object in the room where the rows are the sensor's, shape (7,), else None."""

    def poses(self, progress: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Origins [mm], (P, 3), and rotations body to sensor, (P, 3, 3), at progress (P,)."""
        count = np.arange(len(self.frame_times_s))
        rows = poses_at(self.times_s, self.rows, np.interp(progress, count, self.frame_times_s))
        turned = rotations(rows[:, 3:])
        if self.object_pose is None:
            return rows[:, :3], turned
        back = np.swapaxes(turned, 1, 2)
        origins = np.einsum("pij,pj->pi", back, self.object_pose[:3] - rows[:, :3])
        return origins, back @ rotations(self.object_pose[3:])


def track_of(trajectory: Trajectory, object_pose: np.ndarray | None) -> Track:
    """A trajectory as arrays; with the object's pose in the room, (7,), it is the sensor's."""
    return Track(
        times_s=np.array(trajectory.times_s),
        rows=np.array(trajectory.poses),
        frame_times_s=trajectory.frame_times_s(),
        object_pose=object_pose,
    )


def straight_counts(
    origins_mm: np.ndarray, turned: np.ndarray, overlaps_mm: np.ndarray, arm_mm: float
) -> np.ndarray:
    """How many frames up to and including each go straight on at one velocity, shape (K,), int.

    A frame whose step differs from the one before by more than `SAME_STEP` of it, and one in which
    contact with the undeformed skin begins or ends, begins anew with 1; a frame of rest has 0.

    Args:
        origins_mm: Origins at the start and after each frame, shape (K + 1, 3).
        turned: Rotations body to sensor, shape (K + 1, 3, 3).
        overlaps_mm: Overlap with the undeformed skin there, shape (K + 1,).
        arm_mm: Distance from the origin at which turning counts as moving.
    """
    spins = [quaternion(b @ a.T) for a, b in itertools.pairwise(turned)]
    wxyz = np.reshape(spins, (-1, 4))
    sine = np.linalg.norm(wxyz[:, 1:], axis=1)
    angle = 2.0 * np.arctan2(sine, wxyz[:, 0])
    vector = wxyz[:, 1:] * (angle / np.maximum(sine, 1e-300))[:, None]
    steps = np.concatenate([np.diff(origins_mm, axis=0), arm_mm * vector], axis=1)
    size = np.linalg.norm(steps, axis=1)
    touching = overlaps_mm > 0.0
    counts = np.zeros(len(steps), dtype=np.int64)
    for frame, way_mm in enumerate(size):
        if way_mm < AT_REST_MM:
            continue
        counts[frame] = 1
        if frame and counts[frame - 1] and touching[frame] == touching[frame + 1]:
            change_mm = np.linalg.norm(steps[frame] - steps[frame - 1])
            if change_mm <= SAME_STEP * max(way_mm, size[frame - 1]):
                counts[frame] = counts[frame - 1] + 1
    return counts
