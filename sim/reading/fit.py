"""Gauss-Newton for the inward displacement of the skin: prediction, residual, step.

    min over h of   sum over pixels, colours  w (grey(idle + g E (l(h) - l(0))) - photo)^2
                  + integral (Lap h)^2 / k^2  +  integral h^2 / s^2

l(h) is what the renderer shows of the moved skin, with its shadows and its parallax; its derivative
is that of the light of each vertex by its tilt. k grows from level to level. s is small where the
photograph did not change, and outward displacement costs more: skin is pressed in, and bulges but
little.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from sim.reading.banded import Banded
from sim.reading.patch import Patch, Posed
from sim.reading.pixels import Slopes, gathered, on_tilts
from sim.reading.sight import Sight

LEVELS = ((0.3, 10.0), (0.6, 1.0), (1.0, 0.0))
"""k [1/mm], and the least error that pixels are given, in root mean squares of the first residual:
smooth and forgiving first. A ball of 3 mm has a curvature of .33 per mm."""
MOST_STEPS = 10
"""Of each level."""
FARTHEST_MM = 0.5
"""Largest change of a step."""
RANGE_MM = (-0.1, 4.0)
MOVED_MM, CALM_MM, OUTWARD_MM = 1.5, 0.1, 0.03
"""s where the photograph changed, where it did not, and of what goes outward."""
WORTH, WORTH_LAST = 5e-2, 5e-3
"""A step that gains a smaller share of the cost is the last, of the last level the latter."""
LOST = 5e-2
"""A step that loses a smaller share is the last too: slopes are those of the light by tilt, which
know no shadows, and shorter steps along them gain little. One that loses more is tried shorter."""
SHORTER = 100.0
"""Factor of its damping."""
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
    posed: Posed
    """The moved patch."""
    sight: Sight
    """What the pixels see of it."""
    slopes: Callable[[], Slopes]
    """How it changes with the tilts; asked for where a step begins."""

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

    def stiffness(self, curvature: float):
        """Half the second derivative of what an inward displacement costs, sparse (m, m)."""
        from scipy.sparse import diags

        held = self.area_mm2 / np.where(self.calm, CALM_MM, MOVED_MM) ** 2
        return (self.bending / curvature**2 + diags(held)).tocsr()

    def outward(self, inward_mm: np.ndarray) -> np.ndarray:
        """What is added to its diagonal where a displacement (m,) goes outward, shape (m,)."""
        return np.where(inward_mm < 0.0, self.area_mm2 / OUTWARD_MM**2, 0.0)


@dataclass(frozen=True, kw_only=True, slots=True)
class Fitted:
    """A displacement that explains the photograph."""

    inward_mm: np.ndarray
    """Shape (m,)."""
    matrix: Any
    """Half the second derivative of the cost there, sparse (m, m)."""
    seen: Prediction
    """What it would show."""
    misfit: float
    """Root mean square of residual over noise, of the blocks [1]."""
    steps: int


def fitted(
    patch: Patch,
    priors: Priors,
    predict: Callable[[np.ndarray], Prediction],
    start_mm: np.ndarray,
    *,
    noise_grey: float,
    levels: tuple[tuple[float, float], ...],
) -> Fitted:
    """Fit the free vertices of a patch.

    Args:
        patch: What may move.
        priors: What is believed of it.
        predict: What the patch moved by (m,) [mm] would show.
        start_mm: First guess, shape (m,).
        noise_grey: Standard deviation of a pixel.
        levels: As `LEVELS`.
    """
    steps, inward_mm, seen = 0, start_mm, predict(start_mm)
    spread_grey = seen.spread_grey
    matrix: Any = None
    for curvature, forgiving in levels:
        error_grey = max(noise_grey, forgiving * spread_grey)
        level = _Level(
            patch=patch,
            priors=priors,
            stiffness=priors.stiffness(curvature),
            error_grey=error_grey,
            robust=forgiving == 0.0,
        )
        damping, cost = FIRST_DAMPING, level.cost(inward_mm, seen)
        matrix, pull = level.quadratic(inward_mm, seen)
        for _ in range(MOST_STEPS):
            tried_mm = _stepped(inward_mm, matrix, pull, damping)
            tried = predict(tried_mm)
            steps += 1
            gain = cost - level.cost(tried_mm, tried)
            if gain < -LOST * cost:
                damping *= SHORTER
                continue
            if gain <= 0.0:
                break
            damping = max(0.2 * damping, LEAST_DAMPING)
            inward_mm, seen, cost = tried_mm, tried, cost - gain
            matrix, pull = level.quadratic(inward_mm, seen)
            if gain < (WORTH_LAST if level.robust else WORTH) * cost:
                break
    return Fitted(
        inward_mm=inward_mm,
        matrix=matrix,
        seen=seen,
        misfit=seen.misfit(noise_grey),
        steps=steps,
    )


def _stepped(inward_mm: np.ndarray, matrix: Any, pull: np.ndarray, damping: float) -> np.ndarray:
    """The displacement after a step of a quadratic."""
    step = Banded(matrix, damping).solved(pull)
    step *= min(1.0, FARTHEST_MM / max(float(np.abs(step).max(initial=0.0)), 1e-12))
    return np.clip(inward_mm + step, *RANGE_MM)


@dataclass(frozen=True, kw_only=True)
class _Level:
    """The cost at one k."""

    patch: Patch
    priors: Priors
    stiffness: Any
    """Of the priors, sparse (m, m)."""
    error_grey: float
    """That a pixel is given."""
    robust: bool
    """Whether blocks far off count less."""

    def cost(self, inward_mm: np.ndarray, seen: Prediction) -> float:
        """Of a displacement (m,) and what it would show."""
        told = (self._weight(seen) * seen.residual**2).sum()
        believed = self.stiffness @ inward_mm + self.priors.outward(inward_mm) * inward_mm
        return float(told + inward_mm @ believed)

    def quadratic(self, inward_mm: np.ndarray, seen: Prediction) -> tuple[Any, np.ndarray]:
        """Half the second derivative of the cost, sparse (m, m), and half its fall, (m,)."""
        from scipy.sparse import diags

        evidence = gathered(seen.slopes(), seen.residual, self._weight(seen))
        products, pulls = on_tilts(self.patch.faces, self.patch.count, evidence)
        by_move = self.patch.tilt_slopes(seen.posed)
        outward = self.priors.outward(inward_mm)
        matrix = by_move.T @ (products @ by_move) + self.stiffness + diags(outward)
        believed = self.stiffness @ inward_mm + outward * inward_mm
        return matrix.tocsr(), by_move.T @ pulls - believed

    def _weight(self, seen: Prediction) -> np.ndarray:
        """One over the variance of each block and colour, shape (P, 3)."""
        weight = seen.told / self.error_grey**2
        if not self.robust:
            return weight
        over = np.abs(seen.residual) * np.sqrt(weight)
        return weight * np.minimum(1.0, HUBER / np.maximum(over, 1e-9))
