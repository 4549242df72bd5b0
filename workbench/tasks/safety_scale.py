"""The coefficient of safety: pressure between the least and the largest of the renders.

safety = 1 - (p - low) / (high - low), cut to 0 and 1. Learned is the level of the pressure p on a
scale of factors,

    level = log(p / floor) / log(high / floor),   floor = the larger of low and `FAINTEST` high,

as what changes a pressure (size and edge of the object, depth, Young's modulus) multiplies it. The
coefficient and the pressure that a level stands for are scored.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass

import numpy as np

from workbench.learning.dataset.photo_labels import PEAK
from workbench.tasks.examples import Examples
from workbench.tasks.scores import SAFETY

FAINTEST, ALIKE = 0.02, 1.01
"""Pressures below this share of the largest count as it; renders whose largest is no more than this
many times their least have a scale all the same."""
HIGHEST = 2.0
"""Level beyond which none is told: extrapolated, it would grow without bound."""


@dataclass(frozen=True, kw_only=True, slots=True)
class SafetyScale:
    """What is 1 and what is 0."""

    low_MPa: float
    high_MPa: float

    @classmethod
    def of(cls, found: Examples) -> SafetyScale:
        """That of a set of renders."""
        peaks_MPa = found.truth[:, found.outputs.index(PEAK)]
        return cls(low_MPa=float(peaks_MPa.min()), high_MPa=float(peaks_MPa.max()))

    def safety(self, peak_MPa: np.ndarray) -> np.ndarray:
        """Coefficients of largest pressures."""
        span_MPa = max(self.high_MPa - self.low_MPa, 1e-12)
        return 1.0 - np.clip((peak_MPa - self.low_MPa) / span_MPa, 0.0, 1.0)

    def with_safety(self, found: Examples) -> Examples:
        """Examples whose values are the coefficient and the pressure."""
        peaks_MPa = found.truth[:, [found.outputs.index(PEAK)]]
        truth = np.hstack([self.safety(peaks_MPa), peaks_MPa])
        return dataclasses.replace(found, truth=truth, outputs=(SAFETY, PEAK))

    def level(self, found: Examples) -> np.ndarray:
        """What is learned of examples with coefficient and pressure, shape (N, 1)."""
        peaks_MPa = found.truth[:, [found.outputs.index(PEAK)]]
        floor_MPa, factors = self._scale
        return np.log(np.maximum(peaks_MPa, floor_MPa) / floor_MPa) / factors

    def both(self, level: np.ndarray) -> np.ndarray:
        """Coefficient and pressure of told levels, shape (N, 1) to (N, 2)."""
        floor_MPa, factors = self._scale
        peak_MPa = floor_MPa * np.exp(factors * np.clip(level, 0.0, HIGHEST))
        return np.hstack([self.safety(peak_MPa), peak_MPa])

    @property
    def level_per_log(self) -> float:
        """By how much the level grows where the logarithm of the pressure grows by one."""
        return 1.0 / self._scale[1]

    @property
    def _scale(self) -> tuple[float, float]:
        """Floor [MPa] and the logarithm of how many times it the largest is."""
        floor_MPa = max(self.low_MPa, FAINTEST * self.high_MPa, 1e-12)
        return floor_MPa, float(np.log(max(self.high_MPa / floor_MPa, ALIKE)))
