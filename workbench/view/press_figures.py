"""Figures of a press that are told in many places: how deep each frame is, and what balances."""

from __future__ import annotations

import numpy as np

from workbench.core.press.press import Press
from workbench.core.result.force_field import ForceField
from workbench.core.result.sensing import Contact


def frame_depths_mm(path: Press, contact: Contact | ForceField) -> list[float]:
    """Depth of each frame from first touch along the inward normal [mm], negative when lifted off.

    The object of a trajectory touches anywhere: its depth is how far the skin was pushed inward.
    """
    if path.trajectory is not None:
        pushed_mm = -(contact.displacement_mm @ contact.normal).min(axis=1)
        return [max(0.0, float(depth_mm)) for depth_mm in pushed_mm]
    if path.strokes:
        way_mm = (contact.indenter_pose[0, :3] - contact.indenter_pose[:, :3]) @ contact.normal
        return [float(path.depth_mm / path.frames + inward_mm) for inward_mm in way_mm]
    frames = range(len(contact.reaction_N))
    return [float(path.depth_mm * min(k + 1, path.frames) / path.frames) for k in frames]


def force_balance(contact: Contact) -> float:
    """What is missing between reaction, support and left-out elastomer, over the reaction.

    The support, and the elastomer beyond the region that took part, push the membrane toward the
    indenter; in exact equilibrium of the last frame both together equal the reaction.
    """
    reaction, held = contact.reaction_N[-1], contact.support_N[-1] + contact.cut_N[-1]
    held = held + contact.actuator_N[-1].sum(axis=0) if contact.actuator_N.size else held
    size = float(np.linalg.norm(reaction))
    return float(np.linalg.norm(reaction - held)) / size if size else 0.0
