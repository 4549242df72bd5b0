"""Gauss-Newton for the inward displacement of the skin: prediction, residual, step.

    min over h of   sum over pixels, colours  w (grey(idle + g E (l(h) - l(0))) - photo)^2
                  + integral (Lap h)^2 / k^2  +  integral h^2 / s^2

l(h) is what the renderer shows of the moved skin, with its shadows and its parallax; its derivative
is that of the light of each vertex by its tilt. k grows from level to level. s is small where the
photograph did not change, and outward displacement costs more: skin is pressed in, and bulges but
little.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from sim.reading.patch import Patch
from sim.reading.pixels import gathered, on_tilts

LEVELS = ((0.3, 10.0), (0.6, 1.0), (1.0, 0.0))
"""k [1/mm], and the least error that pixels are given, in root mean squares of the first residual:
smooth and forgiving first. A ball of 3 mm has a curvature of .33 per mm."""
MOST_STEPS = 6
"""Of each level."""
FARTHEST_MM = 0.5
"""Largest change of a step."""
RANGE_MM = (-0.1, 4.0)
MOVED_MM, CALM_MM, OUTWARD_MM = 1.5, 0.1, 0.03
"""s where the photograph changed, where it did not, and of what goes outward."""
WORTH = 2e-3
"""A step that gains a smaller share of the cost is the last."""
HUBER = 3.0
"""Residual over noise from which a pixel counts less, at the last level."""
FIRST_DAMPING, LEAST_DAMPING = 1e-3, 1e-6


@dataclass(frozen=True, kw_only=True, slots=True)
class Prediction:
    """What a moved patch would show, of the P blocks of pixels that are fitted."""

    residual: np.ndarray
    """Photo less prediction [grey], mean of a block, shape (P, 3)."""
    told: np.ndarray
    """Pixels of the block whose colour says something, shape (P, 3)."""
    triangles: np.ndarray
    """Of the patch, that each sees, shape (P,); -1 of others."""
    jacobian: np.ndarray
    """By the tilts of its corners, shape (P, 3, 6)."""
    tilt_slopes: Any
    """Derivatives of the tilts by the moves, sparse (2 n, m)."""

    def misfit(self, noise_grey: float) -> float:
        """Root mean square of residual over noise, of the blocks [1]."""
        over = self.told * self.residual**2 / noise_grey**2
        return float(np.sqrt(over.sum() / max(np.count_nonzero(self.told), 1)))

    @property
    def spread_grey(self) -> float:
        """Root mean square of the residual of a pixel."""
        return float(np.sqrt((self.told * self.residual**2).sum() / max(self.told.sum(), 1.0)))


@dataclass(frozen=True, kw_only=True, slots=True)
class Priors:
    """What is believed without a photograph, of the m free vertices."""

    bending: Any
    """Integral of (Lap h)^2, sparse (m, m)."""
    area_mm2: np.ndarray
    """Shape (m,)."""
    calm: np.ndarray
    """Whether nothing changed there, shape (m,), bool."""

    def matrix(self, curvature: float, inward_mm: np.ndarray):
        """Second derivative of the cost of a displacement (m,), halved, sparse (m, m)."""
        from scipy.sparse import diags

        stiffness = self.area_mm2 / np.where(self.calm, CALM_MM, MOVED_MM) ** 2
        stiffness += np.where(inward_mm < 0.0, self.area_mm2 / OUTWARD_MM**2, 0.0)
        return self.bending / curvature**2 + diags(stiffness)


@dataclass(frozen=True, kw_only=True, slots=True)
class Fitted:
    """A displacement that explains the photograph."""

    inward_mm: np.ndarray
    """Shape (m,)."""
    matrix: Any
    """Half the second derivative of the cost there, sparse (m, m)."""
    misfit: float
    """Root mean square of residual over noise, of the blocks [1]."""
    steps: int


def fitted(
    patch: Patch,
    priors: Priors,
    predict: Any,
    start_mm: np.ndarray,
    *,
    noise_grey: float,
    levels: tuple[tuple[float, float], ...] = LEVELS,
) -> Fitted:
    """Fit the free vertices of a patch.

    Args:
        patch: What may move.
        priors: What is believed of it.
        predict: Gives the `Prediction` of a displacement (m,) [mm].
        start_mm: First guess, shape (m,).
        noise_grey: Standard deviation of a pixel.
        levels: As `LEVELS`.
    """
    inward_mm, steps = start_mm, 0
    best: _State | None = None
    first = predict(start_mm)
    spread_grey = first.spread_grey
    for curvature, forgiving in levels:
        error_grey = max(noise_grey, forgiving * spread_grey)
        robust = (curvature, forgiving) == levels[-1]
        level = _Level(patch, priors, predict, error_grey, curvature, robust=robust)
        damping = FIRST_DAMPING
        best = level.state(inward_mm)
        for _ in range(MOST_STEPS):
            tried_mm = best.stepped(damping)
            steps += 1
            state = level.state(tried_mm)
            if state.cost >= best.cost:
                damping *= 10.0
                continue
            gain = best.cost - state.cost
            damping = max(0.2 * damping, LEAST_DAMPING)
            best = state
            if gain < WORTH * best.cost:
                break
        inward_mm = best.inward_mm
    assert best is not None
    return Fitted(inward_mm=inward_mm, matrix=best.matrix, misfit=best.misfit, steps=steps)


@dataclass(frozen=True, kw_only=True, slots=True)
class _State:
    """A displacement, its cost, and the quadratic about it."""

    inward_mm: np.ndarray
    cost: float
    misfit: float
    matrix: Any
    pull: np.ndarray

    def stepped(self, damping: float) -> np.ndarray:
        """The displacement after a step."""
        from scipy.sparse import diags
        from scipy.sparse.linalg import splu

        damped = (self.matrix + diags(damping * self.matrix.diagonal())).tocsc()
        options = {"SymmetricMode": True}
        step = splu(damped, permc_spec="MMD_AT_PLUS_A", options=options).solve(self.pull)
        step *= min(1.0, FARTHEST_MM / max(float(np.abs(step).max(initial=0.0)), 1e-12))
        return np.clip(self.inward_mm + step, *RANGE_MM)


class _Level:
    """The cost at one k."""

    def __init__(
        self,
        patch: Patch,
        priors: Priors,
        predict: Any,
        noise_grey: float,
        curvature: float,
        *,
        robust: bool,
    ) -> None:
        self.patch, self.priors, self.predict = patch, priors, predict
        self.noise_grey, self.curvature, self.robust = noise_grey, curvature, robust

    def state(self, inward_mm: np.ndarray) -> _State:
        """Cost and quadratic at a displacement (m,)."""
        seen = self.predict(inward_mm)
        over = np.abs(seen.residual) * np.sqrt(seen.told) / self.noise_grey
        weight = seen.told / self.noise_grey**2
        if self.robust:
            weight = weight * np.minimum(1.0, HUBER / np.maximum(over, 1e-9))
        known = seen.triangles >= 0
        evidence = gathered(
            seen.triangles[known],
            len(self.patch.faces),
            seen.jacobian[known],
            seen.residual[known],
            weight[known],
        )
        products, pulls = on_tilts(self.patch.faces, self.patch.count, evidence)
        prior = self.priors.matrix(self.curvature, inward_mm)
        slopes = seen.tilt_slopes
        told = np.count_nonzero(seen.told[known])
        return _State(
            inward_mm=inward_mm,
            cost=float((weight * seen.residual**2).sum() + inward_mm @ (prior @ inward_mm)),
            misfit=float(np.sqrt((over[known] ** 2).sum() / max(told, 1))),
            matrix=(slopes.T @ (products @ slopes) + prior).tocsc(),
            pull=slopes.T @ pulls - prior @ inward_mm,
        )
