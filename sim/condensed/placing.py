"""Where an object first touches, on the part of a skin that it can reach: as quick as a hand."""

from __future__ import annotations

import numpy as np

from sim.contact.motion.approach import FARTHEST_TARGET_MM, Approach, plan_approach
from sim.contact.objects.collider import Collider
from workbench.core.press.press import Press
from workbench.core.result.results import Skin

BESIDE_MM = 2.0
"""Room beside what an object can reach, for triangles that only one corner of lies in it [mm]."""


def placed_near(outer: Skin, collider: Collider, press: Press) -> Approach:
    """As `plan_approach`, with the skin farther from the target than the object reaches left out.

    A skin that is met there first, far from the target, is not noticed; the contact solver refuses
    such a press.

    Raises:
        DesignError: If the target is not near the skin, or the object misses it there.
        SolveError: If the first touch cannot be found.
    """
    radius_mm = FARTHEST_TARGET_MM + 2.0 * collider.reach_mm + BESIDE_MM
    return plan_approach(part_near(outer, np.array(press.target_mm), radius_mm), collider, press)


def part_near(skin: Skin, centre_mm: np.ndarray, radius_mm: float) -> Skin:
    """The triangles of a skin with a corner so near a place; the whole where there are none."""
    near = np.einsum("vi,vi->v", *2 * (skin.points_mm - centre_mm,)) < radius_mm**2
    faces = skin.faces[near[skin.faces].any(axis=1)]
    if not len(faces):
        return skin
    kept, faces_of_kept = np.unique(faces, return_inverse=True)
    return Skin(
        points_mm=skin.points_mm[kept],
        faces=faces_of_kept.reshape(faces.shape).astype(np.int32),
        normals=skin.normals[kept],
    )
