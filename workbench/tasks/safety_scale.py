"""The coefficient of safety: pressure between the least and the largest of the renders.

safety = 1 - (p - low) / (high - low), cut to 0 and 1. Learned is the coefficient; the pressure that
it stands for is scored beside it.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass

import numpy as np

from workbench.learning.dataset.photo_labels import PEAK
from workbench.tasks.examples import Examples
from workbench.tasks.scores import SAFETY


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

    def both(self, safety: np.ndarray) -> np.ndarray:
        """Coefficient and pressure of told coefficients, shape (N, 1) to (N, 2)."""
        kept = np.clip(safety, 0.0, 1.0)
        peak_MPa = self.low_MPa + (1.0 - kept) * (self.high_MPa - self.low_MPa)
        return np.hstack([kept, peak_MPa])
