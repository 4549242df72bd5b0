"""How strongly an LED shines into each direction: its lobe, cos^m within a cone.

On the device `shade_kernels.lobe` does the same for skin that moves, and photons begin in such
directions in `transport.emission_functions`.
"""

from __future__ import annotations

import numpy as np


def emitted(
    direction: np.ndarray,
    distance_mm: np.ndarray,
    *,
    axis: np.ndarray,
    exponent: float,
    cone: float = 0.0,
) -> np.ndarray:
    """Perpendicular irradiance [1/mm2] per unit of power, I0 cos^m / r^2 within the cone.

    I0 = (m + 1) / (2 pi (1 - cone^(m + 1))), so that the power is the same for every cone.

    Args:
        direction: Unit vectors from the points to the LED, shape (N, 3).
        distance_mm: Their distances, shape (N,).
        axis: Unit emission axis of the LED, shape (3,).
        exponent: m; 0 shines evenly into the cone.
        cone: Cosine of half the emission cone [1]; 0 is the half space of the axis.
    """
    cosine = -(direction @ axis)
    lobe = np.where(cosine > cone, np.maximum(cosine, 0.0) ** exponent, 0.0)
    share = 1.0 - cone ** (exponent + 1.0)
    return (exponent + 1.0) / (2.0 * np.pi * share) * lobe / distance_mm**2
