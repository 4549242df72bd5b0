"""Von Mises stress: the size of what shears, of a stress tensor.

    sqrt(((xx - yy)^2 + (yy - zz)^2 + (zz - xx)^2) / 2 + 3 (xy^2 + yz^2 + zx^2))

which is sqrt(3/2 s : s) with s the deviator. Source: R. von Mises, Goettinger Nachrichten (1913).
"""

from __future__ import annotations

import numpy as np


def von_mises_MPa(stress_MPa: np.ndarray) -> np.ndarray:
    """Von Mises stress [MPa], shape (...), float32, of xx, yy, zz, xy, yz, zx, shape (..., 6)."""
    direct, shear = np.split(np.asarray(stress_MPa, dtype=np.float64), 2, axis=-1)
    apart = np.square(direct - np.roll(direct, -1, axis=-1)).sum(axis=-1) / 2.0
    return np.sqrt(apart + 3.0 * np.square(shear).sum(axis=-1)).astype(np.float32)
