"""The null of a force: k times the depth."""

from __future__ import annotations

import numpy as np


def spring(depth_mm: np.ndarray, force_N: np.ndarray) -> float:
    """The k [N/mm] whose k times depth has the least relative error, in squares."""
    share = depth_mm / force_N
    return float(share.sum() / (share @ share))
