"""The signed distance of an object, sampled on a grid of its body frame."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np


def _whole() -> np.ndarray:
    return np.zeros((2, 3), dtype=bool)


@dataclass(frozen=True, kw_only=True, slots=True)
class SampledDistance:
    """A distance field on a grid."""

    coefficients: np.ndarray
    """Quadratic B-spline coefficients [mm], shape (A, B, C), float64."""
    origin_mm: np.ndarray
    """Position of sample (0, 0, 0) [mm], shape (3,)."""
    spacing_mm: float
    """Distance of samples; larger than asked where memory bounds it."""
    cut: np.ndarray = field(default_factory=_whole)
    """Lower and upper sides beyond which the body goes on, (2, 3): the field says nothing there."""
