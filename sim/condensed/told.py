"""What fast contact felt, as a `Contact` of one frame, for who shows presses of every solver."""

from __future__ import annotations

import numpy as np

from sim.condensed.fast_contact import Touch
from sim.condensed.surface import Surface
from sim.contact.motion.approach import Approach
from workbench.core.result.sensing import Contact

UNKNOWN = np.full(1, np.nan)


def contact_of(touch: Touch, approach: Approach, pose: np.ndarray, outer: Surface) -> Contact:
    """The one press of a frame.

    Residual, penetration and the forces of the support are not known to fast contact: NaN.

    Args:
        touch: Of one press.
        approach: Where it was aimed.
        pose: Of the object, shape (7,).
        outer: How the design's outer skin follows the nodes.
    """
    moved_mm = outer.displacement_mm(touch.displacement_mm)
    pressure_MPa = outer.displacement_mm(touch.pressure_MPa[:, :, None])[:, :, 0]
    return Contact(
        displacement_mm=moved_mm,
        reaction_N=touch.force_N.astype(np.float64),
        moment_Nmm=touch.moment_Nmm.astype(np.float64),
        indenter_pose=np.asarray(pose, np.float64)[None],
        residual=UNKNOWN,
        penetration_mm=UNKNOWN,
        support_N=np.full((1, 3), np.nan),
        cut_N=np.full((1, 3), np.nan),
        friction_ratio=touch.friction_ratio.astype(np.float64),
        sliding=np.zeros(moved_mm.shape[:2], dtype=bool),
        target_mm=approach.target_mm,
        normal=approach.normal,
        tangent_u=approach.tangent_u,
        grid_mm=np.nan,
        active_radius_mm=np.nan,
        particles=0,
        substeps=0,
        device="",
        pressure_MPa=np.maximum(pressure_MPa, 0.0),
    )
