"""How flat is what a camera sees: Taxim knows a flat gel, seen straight on, by one scale."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from workbench.core.base.errors import DesignError

if TYPE_CHECKING:
    from sim.optics.raster.skin_view import SkinView
    from workbench.core.result.results import Skin

FACING_DEG = 10.0
"""Skin whose normal is within so much of the camera's axis counts as flat."""
LEAST_FLAT = 0.75
"""Share of the pixels that see skin which must see such."""
MOST_SPREAD = 1.25
"""Largest over smallest mm per pixel there, between the 5th and the 95th hundredth."""


@dataclass(frozen=True, kw_only=True, slots=True)
class FlatView:
    """The flat part of an image."""

    flat: np.ndarray
    """Pixels that see it, shape (H, W), bool."""
    share: float
    """Of the pixels that see skin."""
    mm_per_px: float
    """The median."""
    between_mm_per_px: tuple[float, float]
    """The 5th and the 95th hundredth."""


def flat_view(view: SkinView, skin: Skin, axis: np.ndarray) -> FlatView:
    """The flat part of an image at rest, before any light is known.

    Args:
        view: What the pixels see of the skin.
        skin: The undeformed skin.
        axis: The camera's axis, forward, shape (3,).

    Raises:
        DesignError: If too little of it is flat, or its scale differs too much over the image.
    """
    facing = float(np.cos(np.radians(FACING_DEG)))
    there = np.flatnonzero(np.diff(view.layer_start) > 0)
    faces = view.faces[view.layer_face[view.layer_start[there]]]
    normals = np.asarray(skin.normals)[faces].mean(axis=1)
    flat = np.zeros(view.height_px * view.width_px, dtype=bool)
    flat[there] = normals @ axis > facing * np.linalg.norm(normals, axis=1)
    share = float(flat.sum() / max(len(there), 1))
    if share < LEAST_FLAT:
        raise DesignError(
            f"{share:.0%} of the skin that the camera sees faces it within {FACING_DEG:g} degrees; "
            f"the format of Taxim is for flat gels, {LEAST_FLAT:.0%} or more",
            hint="take --pack: wb.Sensor shows curved skins",
            at="--taxim",
        )
    low, middle, high = np.percentile(_scales(view, skin, axis), [5.0, 50.0, 95.0])
    if high > MOST_SPREAD * low:
        raise DesignError(
            f"a pixel sees from {low:.3f} to {high:.3f} mm of the flat skin; the format of Taxim "
            f"has one scale for the image, and {MOST_SPREAD:g} times is the limit",
            hint="turn the camera to face the skin, or take --pack",
            at="--taxim",
        )
    return FlatView(
        flat=flat.reshape(view.height_px, view.width_px),
        share=share,
        mm_per_px=float(middle),
        between_mm_per_px=(float(low), float(high)),
    )


def _scales(view: SkinView, skin: Skin, axis: np.ndarray) -> np.ndarray:
    """mm per pixel of the flat triangles that the camera sees, shape (n,)."""
    px = view.start_pixel.astype(float)
    faces = skin.faces[(view.projects & view.visible)[skin.faces].all(axis=1)]
    corners = skin.points_mm[faces]
    doubled = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    doubled_mm2 = np.abs(doubled @ axis)
    one, other = px[faces[:, 1]] - px[faces[:, 0]], px[faces[:, 2]] - px[faces[:, 0]]
    doubled_px2 = np.abs(one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0])
    facing = np.cos(np.radians(FACING_DEG))
    flat = doubled_mm2 > facing * np.linalg.norm(doubled, axis=1)
    return np.sqrt(doubled_mm2[flat] / np.maximum(doubled_px2[flat], 1e-12))
