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
SAME_PLACE = 0.1
"""Distance of two presses' middles over half the diagonal [1] up to which they are at one place."""
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
    """Centres (M, 4) and weights (M, 3) of the residual; none where it would only be learned by
    heart.

    Each press is also predicted by a residual of those that are elsewhere. If that leaves more than
    no residual at all, there are too few presses for one: read with it, a finger's twin that was
    calibrated to six photographs had a third of its depth.

    Args:
        seen: Of each press.
        left: Photograph less prediction at its pixels [grey level], (P, 3) each.
        usable: Pixels where neither is cut off, (P,) each, bool.
    """
    whole = _solved(seen, left, usable)
    return whole if _carries(seen, left, usable) else (np.zeros((0, 4)), np.zeros((0, 3)))


def _carries(seen: list[Slopes], left: list[np.ndarray], usable: list[np.ndarray]) -> bool:
    """Whether a residual of presses elsewhere leaves less of each press than none does."""
    middles = np.array(
        [each.place.mean(axis=0) if len(each.place) else [9.0, 9.0] for each in seen]
    )
    with_it = without = 0.0
    for number, each in enumerate(seen):
        away = np.linalg.norm(middles - middles[number], axis=1) > SAME_PLACE
        others = np.flatnonzero(away)
        if not len(others) or not len(each.place):
            continue
        centres, weights = _solved(
            [seen[k] for k in others], [left[k] for k in others], [usable[k] for k in others]
        )
        at = np.hstack([each.slope, each.place]) / REACH
        fade = np.clip(np.linalg.norm(each.slope, axis=1) / FADE_SLOPE, 0.0, 1.0)[:, None]
        told = fade * (kernels(at, centres) @ weights) if len(centres) else 0.0
        kept = usable[number]
        with_it += float(((left[number] - told)[kept] ** 2).sum())
        without += float((left[number][kept] ** 2).sum())
    return with_it <= without


def _solved(
    seen: list[Slopes], left: list[np.ndarray], usable: list[np.ndarray]
) -> tuple[np.ndarray, np.ndarray]:
    """Centres and weights of the residual of some presses."""
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
