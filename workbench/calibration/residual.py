"""What is left between photographs and the fitted light, as a function of slope and place.

Ridge regression on Gaussian kernels about `CENTRES` of the samples; the equation stands in
`sim.optics.studio.unit_residual`. A kernel reaches over slopes of .4 and half of the half diagonal,
so the residual is smooth, is learned from few presses, and vanishes where nothing was photographed.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim.optics.studio.unit_residual import FADE_SLOPE, kernels

CENTRES = 400
SAMPLES = 40_000
"""Of all presses together, at most."""
REACH = np.array([0.4, 0.4, 0.5, 0.5], dtype=np.float32)
"""Of slopes [1], and of places over half the diagonal [1]."""
RIDGE = 0.1
"""Samples' worth of noise against a kernel's own size [1]; between .01 and .1 scores alike."""
SEED = 1


@dataclass(frozen=True, kw_only=True, slots=True)
class Slopes:
    """One press as the camera sees it, at P pixels that changed."""

    slope: np.ndarray
    """Shape (P, 2)."""
    place: np.ndarray
    """Shape (P, 2)."""
    pixel: np.ndarray
    """Their numbers, shape (P,)."""


def fit_residual(
    seen: list[Slopes], left: list[np.ndarray], usable: list[np.ndarray]
) -> tuple[np.ndarray, np.ndarray]:
    """Centres (M, 4) and weights (M, 3) of the residual.

    Args:
        seen: Of each press.
        left: Photograph less prediction at its pixels [grey level], (P, 3) each.
        usable: Pixels where neither is cut off, (P,) each, bool.
    """
    at = np.concatenate([np.hstack([each.slope, each.place]) for each in seen])
    target = np.concatenate(left)
    tilted = np.linalg.norm(at[:, :2], axis=1) > FADE_SLOPE / 2.0
    keep = np.flatnonzero(np.concatenate(usable) & tilted)
    random = np.random.default_rng(SEED)
    if len(keep) > SAMPLES:
        keep = random.choice(keep, SAMPLES, replace=False)
    points = (at[keep] / REACH).astype(np.float64)
    count = min(CENTRES, len(points))
    if not count:
        return np.zeros((0, 4)), np.zeros((0, 3))
    centres = points[random.choice(len(points), count, replace=False)]
    among = kernels(points, centres)
    own = kernels(centres, centres)
    share = len(points) / count
    square = among.T @ among + RIDGE * share * own + 1e-6 * share * np.eye(count)
    return centres, np.linalg.solve(square, among.T @ target[keep])
