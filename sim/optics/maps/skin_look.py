"""What a camera tells of each vertex of the skin."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, kw_only=True, slots=True)
class SkinLook:
    """What a camera tells of each vertex; NaN where it does not see it."""

    visible: np.ndarray
    """Shape (V,), bool."""
    mm_per_pixel: np.ndarray
    incidence_deg: np.ndarray
    jacobian: np.ndarray
    """Change of grey by tilt, as `signal.tilt_jacobian`."""
    noise: np.ndarray
    glare: np.ndarray
    """Over the skin's own radiance."""
    overexposed: np.ndarray
    """Shape (V,), bool: whether a colour of its pixel is at the sensor's ceiling."""
