"""A trajectory to begin from: what is pressed now, else straight down where the object stands."""

from __future__ import annotations

import numpy as np

from workbench.core.base.poses import rotations
from workbench.core.press.press import Press
from workbench.core.result.sensing import Contact
from workbench.edit.trajectories import pose_csv, press_poses

ABOVE_MM = 1.0
"""Height over the skin at which the template starts."""


def template_csv(press: Press, contact: Contact | None, standing: np.ndarray) -> str:
    """The text of a trajectory file.

    Args:
        press: The press.
        contact: Its result, or None: then the path is guessed.
        standing: x, y, z [mm], qw, qx, qy, qz of the object on the skin.
    """
    if contact is not None:
        return pose_csv(*press_poses(press, contact))
    outward = rotations(standing[None, 3:])[0][:, 2]
    heights_mm = np.r_[ABOVE_MM, -press.depth_mm * np.arange(1, press.frames + 1) / press.frames]
    poses = np.tile(standing, (len(heights_mm), 1))
    poses[:, :3] += heights_mm[:, None] * outward
    return pose_csv(np.arange(float(len(poses))), poses)
