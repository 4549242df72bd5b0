"""Maps of a read touch, whatever reader read it; and from what depth on skin counts as pressed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

TOUCHED_MM = 0.05
"""Least inward displacement that counts as contact."""
SURE = 2.0
"""And the least number of its standard deviations."""
SUREST = 3.0
"""Least number of standard deviations, somewhere in a contact."""


@dataclass(frozen=True, kw_only=True, slots=True)
class PixelMaps:
    """Of an image of H x W pixels; NaN where no skin is seen."""

    depth_mm: np.ndarray
    """Inward displacement of the skin that a pixel sees, shape (H, W), float32."""
    normal: np.ndarray
    """Its unit normals into the sensor, shape (H, W, 3), float32."""
    contact: np.ndarray
    """Whether it is pressed in, shape (H, W), bool."""
    sigma_mm: np.ndarray
    """Standard deviation of the depth, shape (H, W), float32."""


def pressed(inward_mm: np.ndarray, sigma_mm: np.ndarray) -> np.ndarray:
    """Vertices that are surely pressed in, shape (V,), bool.

    Args:
        inward_mm: Their inward displacement, shape (V,).
        sigma_mm: Its standard deviation, shape (V,); NaN where nothing is known.
    """
    doubt_mm = np.nan_to_num(sigma_mm, nan=np.inf)
    return (inward_mm > TOUCHED_MM) & (inward_mm > SURE * doubt_mm)
