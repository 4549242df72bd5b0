"""What a press may not do: reach the support, overlap, crush the elastomer, or miss the skin."""

from __future__ import annotations

import dataclasses
import math

import numpy as np

from sim.contact.motion.approach import SHALLOW_MM, Approach
from sim.contact.readout.frame import FrameOutcome, deepest_overlap_mm
from workbench.core.base.errors import DesignError, SolveError
from workbench.core.press.press import Press

POSES = 12
"""Least number of poses of shear and twist at which the support is looked at."""
INWARD_EVERY_MM = 0.25
"""Way of the approach between two poses at which the support is looked at: half of the smallest
indenter."""
POSE_EVERY_MM = 0.5
"""Way between two poses at which the support is looked at."""
MOST_POSES = 50
"""Poses of one frame at which the support is looked at."""
DEEPEST_OVERLAP = 0.5
"""Overlap of a settled frame that is still a contact, in cells."""
LEAST_VOLUME_RATIO = 0.02
"""J below which a point counts as crushed: the material law ends at 0."""


def check_depth(support_mm: np.ndarray, approach: Approach) -> None:
    """Refuse a path on which the rigid indenter meets the rigid support.

    Args:
        support_mm: Points of the support [mm], shape (N, 3).
        approach: The indenter and its path.

    Raises:
        DesignError: With the largest depth that fits, or with the frame and row that does not.
    """
    if approach.track is None:
        _check_press(support_mm, approach)
    if approach.track is not None or approach.legs:
        _check_frames(support_mm, approach)


def _check_press(support_mm: np.ndarray, approach: Approach) -> None:
    """Approach, shear and twist."""
    press = approach.press
    if not _meets_support(support_mm, approach, press.depth_mm):
        return
    fits_mm, meets_mm = 0.0, press.depth_mm
    while meets_mm - fits_mm > 1e-3:
        middle_mm = 0.5 * (fits_mm + meets_mm)
        if _meets_support(support_mm, approach, middle_mm):
            meets_mm = middle_mm
        else:
            fits_mm = middle_mm
    raise DesignError(
        f"at a depth of {press.depth_mm:g} mm the indenter reaches the support; the largest depth "
        f"that fits is {math.floor(10.0 * fits_mm) / 10.0:.1f} mm",
        hint="lower press.depth_mm or raise layers.elastomer_mm",
        at="press.depth_mm",
    )


def _meets_support(support_mm: np.ndarray, approach: Approach, depth_mm: float) -> bool:
    press = dataclasses.replace(approach.press, depth_mm=depth_mm, strokes=())
    path = dataclasses.replace(approach, press=press, legs=())
    # On the way down too: a depth of 50 mm passes right through a finger.
    inward = math.ceil(depth_mm / INWARD_EVERY_MM) + 1
    progress = np.linspace(press.frames, 0.0, inward)
    if press.sliding:
        way_mm = sum(path.travel_mm(k, path.collider.reach_mm) for k in _sideways(press))
        count = max(POSES, math.ceil(way_mm / POSE_EVERY_MM))
        progress = np.append(progress, np.linspace(press.frames, press.approach_frames, count))
    origins, turned = path.poses(progress)
    return any(
        deepest_overlap_mm(support_mm, path.collider, origin, rotation) > 0.0
        for origin, rotation in zip(origins, turned, strict=True)
    )


def _sideways(press: Press) -> range:
    """Frames of shear and twist."""
    return range(press.frames, press.approach_frames)


def _check_frames(support_mm: np.ndarray, approach: Approach) -> None:
    """Strokes and trajectories, frame by frame and on the way."""
    begin = 0 if approach.track is not None else approach.press.approach_frames
    for frame in range(begin, approach.frame_count):
        way_mm = approach.travel_mm(frame, approach.collider.reach_mm)
        count = min(max(1, math.ceil(way_mm / POSE_EVERY_MM)), MOST_POSES)
        origins, turned = approach.poses(frame + (np.arange(count) + 1.0) / count)
        deepest_mm = max(
            deepest_overlap_mm(support_mm, approach.collider, origin, rotation)
            for origin, rotation in zip(origins, turned, strict=True)
        )
        if deepest_mm > 0.0:
            raise _support_met(approach, frame, deepest_mm)


def _support_met(approach: Approach, frame: int, deepest_mm: float) -> DesignError:
    label = f"frame {frame + 1} of {approach.frame_count}"
    reaches = f"the object reaches {deepest_mm:.2g} mm into the rigid support"
    trajectory = approach.press.trajectory
    if trajectory is not None:
        row = int(np.searchsorted(trajectory.times_s, trajectory.frame_times_s()[frame + 1])) + 1
        return DesignError(
            f"{label} (row {row} of the trajectory): {reaches}",
            hint=f"move that row outward by at least {deepest_mm:.2g} mm",
            at="press.trajectory",
        )
    number = sum(leg.first <= frame for leg in approach.legs)
    text = approach.press.strokes[number - 1].text
    return DesignError(
        f"{label} (stroke {number}, {text}): {reaches}",
        hint="make the stroke shorter, lower press.depth_mm or raise layers.elastomer_mm",
        at="press.strokes",
    )


def check_frame(outcome: FrameOutcome, approach: Approach, frame: int, *, grid_mm: float) -> None:
    """Refuse a settled frame that is no contact of this elastomer.

    Raises:
        SolveError: If skin and object overlap, the elastomer is crushed, or there is no force.
    """
    label = f"frame {frame + 1} of {approach.frame_count}"
    fault = {"frame": frame, "residual": outcome.residual, "last_good": frame - 1}
    if approach.pressing(frame) and not outcome.reaction_N.any():
        raise SolveError(
            f"{label} is {approach.depth_mm(frame):.3f} mm deep with no force: the object passed "
            f"between contact points; forces are due from {SHALLOW_MM:g} mm",
            hint="lower contact.grid_mm or meshing.hex_mm, or raise indenter.edge_radius_mm",
            at="contact.grid_mm",
            **fault,
        )
    limit_mm = DEEPEST_OVERLAP * grid_mm
    if not outcome.penetration_mm <= limit_mm:
        raise SolveError(
            f"{label}: skin and object overlap by {outcome.penetration_mm:.3f} mm; the limit is "
            f"{limit_mm:.3f} mm",
            hint="lower contact.grid_mm, raise contact.active_radius_mm or contact.penalty",
            at="contact.grid_mm",
            **fault,
        )
    least = outcome.least_volume_ratio
    if not least >= LEAST_VOLUME_RATIO:
        raise SolveError(
            f"{label}: the elastomer is crushed to {least:.3f} of its volume; the limit is "
            f"{LEAST_VOLUME_RATIO:g}",
            hint="lower press.depth_mm or contact.grid_mm",
            at="press.depth_mm",
            **fault,
        )
