"""Young's modulus from presses whose force was measured.

At a given depth every force of the contact solver is in proportion to Young's modulus E: friction
and Poisson's ratio are ratios. A press that needed F where the solver, with the design's E0, finds
f at the fitted depth says E = E0 F / f. Presses are averaged in the logarithm; the standard
deviation has their scatter, and what the depths, which are fitted too, are not known to.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from workbench.calibration.ball_presses import BallPress

LEAST_SCATTER = 0.03
"""Of one press about the mean of many, relative [1]: force gauges and the solver's grid."""
STEP_MM = 0.02
"""Depth over which the force's rise is taken [mm]."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Young:
    """What the forces say."""

    young_MPa: float
    sd_MPa: float
    presses: int


def fitted_young(
    young_MPa: float,
    presses: Sequence[BallPress],
    depths_mm: np.ndarray,
    covariance_mm2: np.ndarray,
) -> Young | None:
    """Young's modulus; None where no force was measured.

    Args:
        young_MPa: What the presses were solved with.
        presses: Of the fitted photographs, shape (J,).
        depths_mm: Their depths, shape (J,).
        covariance_mm2: Of these, shape (J, J).
    """
    measured = np.flatnonzero([each.photo.force_N is not None for each in presses])
    ratios, rise = [], np.zeros(len(presses))
    for number in measured.tolist():
        press, depth = presses[number], float(depths_mm[number])
        force_N = press.force_N(depth)
        measured_N = press.photo.force_N
        if measured_N is None or force_N <= 0.0:
            continue
        ratios.append(np.log(measured_N / force_N))
        low, high = depth - STEP_MM, min(depth + STEP_MM, float(press.depths_mm[-1]))
        rise[number] = (press.force_N(high) - press.force_N(low)) / (high - low) / force_N
    if not ratios:
        return None
    count = len(ratios)
    scatter = max(float(np.std(ratios, ddof=1)) if count > 1 else 0.0, LEAST_SCATTER)
    slope = rise / count
    relative = np.sqrt(scatter**2 / count + slope @ covariance_mm2 @ slope)
    found_MPa = young_MPa * float(np.exp(np.mean(ratios)))
    return Young(young_MPa=found_MPa, sd_MPa=found_MPa * float(relative), presses=count)
