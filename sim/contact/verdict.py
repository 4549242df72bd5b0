"""What a press may not do: reach the support, overlap, crush the elastomer, or miss the skin."""

from __future__ import annotations

import dataclasses
import math

import numpy as np

from sim.contact.approach import Approach
from sim.contact.collider import Collider
from sim.contact.frame import FrameOutcome, deepest_overlap_mm
from workbench.core.errors import DesignError, SolveError

POSES = 12
"""Poses of shear and twist at which the support is looked at."""
DEEPEST_OVERLAP = 0.5
"""Overlap of a settled frame that is still a contact, in cells."""
LEAST_VOLUME_RATIO = 0.02
"""J below which a point counts as crushed: the material law ends at 0."""
SHALLOW_MM = 1e-3
"""Depth up to which a frame may have no reaction."""


def check_depth(support_mm: np.ndarray, approach: Approach, collider: Collider) -> None:
    """Refuse a path on which the rigid indenter meets the rigid support.

    Args:
        support_mm: Points of the support [mm], shape (N, 3).
        approach: The path.
        collider: The indenter.

    Raises:
        DesignError: With the largest depth that fits.
    """
    press = approach.press
    if not _meets_support(support_mm, approach, collider, press.depth_mm):
        return
    fits_mm, meets_mm = 0.0, press.depth_mm
    while meets_mm - fits_mm > 1e-3:
        middle_mm = 0.5 * (fits_mm + meets_mm)
        if _meets_support(support_mm, approach, collider, middle_mm):
            meets_mm = middle_mm
        else:
            fits_mm = middle_mm
    raise DesignError(
        f"at a depth of {press.depth_mm:g} mm the indenter reaches the support; the largest depth "
        f"that fits is {math.floor(10.0 * fits_mm) / 10.0:.1f} mm",
        hint="lower press.depth_mm or raise layers.elastomer_mm",
        at="press.depth_mm",
    )


def _meets_support(
    support_mm: np.ndarray, approach: Approach, collider: Collider, depth_mm: float
) -> bool:
    press = dataclasses.replace(approach.press, depth_mm=depth_mm)
    path = dataclasses.replace(approach, press=press)
    slides = press.frame_count - press.frames
    poses = np.linspace(press.frames, press.frame_count, POSES if slides else 1)
    return any(
        deepest_overlap_mm(support_mm, collider, *path.pose(float(pose))) > 0.0 for pose in poses
    )


def check_frame(outcome: FrameOutcome, approach: Approach, frame: int, *, grid_mm: float) -> None:
    """Refuse a settled frame that is no contact of this elastomer.

    Raises:
        SolveError: If skin and object overlap, the elastomer is crushed, or there is no force.
    """
    press = approach.press
    label = f"frame {frame + 1} of {approach.frame_count}"
    depth_mm = press.depth_mm * min(1.0, (frame + 1) / press.frames)
    fault = {"frame": frame, "residual": outcome.residual, "last_good": frame - 1}
    if frame < press.frames and depth_mm > SHALLOW_MM and not outcome.reaction_N.any():
        raise SolveError(
            f"{label} is {depth_mm:.3f} mm deep with no force: the object passed between contact "
            f"points; forces are due from {SHALLOW_MM:g} mm",
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
