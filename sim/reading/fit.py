"""Gauss-Newton for the inward displacement of the skin: prediction, residual, step.

    min over h of   sum over pixels, colours  w (grey(idle + g E (l(h) - l(0))) - photo)^2
                  + integral (Lap h)^2 / k^2  +  integral h^2 / s^2

l(h) is what the renderer shows of the moved skin, with its shadows and its parallax; its derivative
is that of the light of each vertex by its tilt. w grows from level to level. s is small where the
photograph did not change, and outward displacement costs more: skin is pressed in, and bulges but
little.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from sim.reading.banded import Banded
from sim.reading.deviation import Linear
from sim.reading.noise import Noise
from sim.reading.patch import Patch, Posed
from sim.reading.pixels import Slopes, gathered, on_tilts
from sim.reading.sight import Sight

LEVELS = (10.0, 1.0, 0.0)
"""The least error that pixels are given, in root mean squares of the first residual: forgiving
first."""
CURVATURE = 0.25
"""k [1/mm]. A ball of 3 mm has a curvature of .33 per mm, and the edge of a cross of 2 mm is still
read better with it than with 1. Where skin is in shadow, or the light of a built sensor is not
quite known, with 1 bumps between vertices explain colours that no smooth skin does: pressed objects
in calibrated twins of pad and finger are then .072 and .067 mm off, with .2 to .3 .055 to .058
and .060 to .061."""
MOST_STEPS = 10
"""Of each level."""
FARTHEST_MM = 0.5
"""Largest change of a step."""
RANGE_MM = (-0.1, 4.0)
MOVED_MM, CALM_MM, OUTWARD_MM = 1.5, 0.1, 0.03
"""s where the photograph changed, where it did not, and of what goes outward."""
WORTH, WORTH_LAST = 5e-2, 5e-3
"""A step that gains a smaller share of the cost is the last, of the last level the latter."""
HOPELESS = 0.3
"""Share of that which a step must promise: to draw a skin takes longer than to promise. Of 18 dents
in a finger the mean error of depth is 15.5 um with it and without it."""
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

    def misfit(self, noise: Noise) -> float:
        """Root mean square of residual over noise, of the blocks [1]."""
        over = self.residual**2 / noise.of_block(self.told)
        return float(np.sqrt(over.sum() / max(np.count_nonzero(self.told), 1)))

    @property
    def spread_grey(self) -> float:
        """Root mean square of the residual of a pixel."""
        return float(np.sqrt((self.told * self.residual**2).sum() / max(self.told.sum(), 1.0)))


@dataclass(frozen=True, kw_only=True, slots=True)
class Priors:
    """What is believed without a photograph, of the m free vertices."""

    bent: Any
    """Lap h times the root of the area of each vertex [1/mm], sparse (v, m)."""
    area_mm2: np.ndarray
    """Shape (m,)."""
    calm: np.ndarray
    """Whether nothing changed there, shape (m,), bool."""

    def root(self):
        """R of R^T R, half the second derivative of what an inward displacement costs, sparse."""
        from scipy.sparse import diags, vstack

        held = np.sqrt(self.area_mm2) / np.where(self.calm, CALM_MM, MOVED_MM)
        return vstack([self.bent / CURVATURE, diags(held)]).tocsr()

    def outward(self, inward_mm: np.ndarray) -> np.ndarray:
        """What is added to its diagonal where a displacement (m,) goes outward, shape (m,)."""
        return np.where(inward_mm < 0.0, self.area_mm2 / OUTWARD_MM**2, 0.0)


@dataclass(frozen=True, kw_only=True, slots=True)
class Fitted:
    """A displacement that explains the photograph."""

    inward_mm: np.ndarray
    """Shape (m,)."""
    linear: Linear
    """The fit at its last step."""
    seen: Prediction
    """What it would show."""
    misfit: float
    """Root mean square of residual over noise, of the blocks [1]."""
    steps: int


def fitted(
    patch: Patch,
    priors: Priors,
    predict: Callable[[np.ndarray], Prediction],
    start: tuple[np.ndarray, Prediction],
    *,
    noise: Noise,
    levels: tuple[float, ...],
) -> Fitted:
    """Fit the free vertices of a patch.

    Args:
        patch: What may move.
        priors: What is believed of it.
        predict: What the patch moved by (m,) [mm] would show.
        start: First guess, shape (m,), and what it would show.
        noise: Of the photograph.
        levels: As `LEVELS`.
    """
    steps, (inward_mm, seen) = 0, start
    spread_grey = seen.spread_grey
    root = priors.root()
    stiffness = (root.T @ root).tocsr()
    for forgiving in levels:
        level = _Level(
            patch=patch,
            priors=priors,
            stiffness=stiffness,
            error_grey2=max(noise.of_many(), (forgiving * spread_grey) ** 2),
            robust=forgiving == 0.0,
        )
        damping, cost = FIRST_DAMPING, level.cost(inward_mm, seen)
        near = level.near(inward_mm, seen)
        worth = WORTH_LAST if level.robust else WORTH
        for _ in range(MOST_STEPS):
            factors = Banded(near.matrix, damping)
            step_mm = factors.solved(near.pull)
            if step_mm @ near.pull < HOPELESS * worth * cost:
                break
            tried_mm = _stepped(inward_mm, step_mm)
            tried = predict(tried_mm)
            steps += 1
            gain = cost - level.cost(tried_mm, tried)
            if gain < -LOST * cost:
                damping *= SHORTER
                continue
            if gain <= 0.0:
                break
            inward_mm, seen, cost = tried_mm, tried, cost - gain
            if gain < worth * cost:
                break
            damping = max(0.2 * damping, LEAST_DAMPING)
            near = level.near(inward_mm, seen)
    if damping > FIRST_DAMPING:
        factors = Banded(near.matrix)
    return Fitted(
        inward_mm=inward_mm,
        linear=Linear(
            factors=factors,
            slopes=near.slopes,
            by_move=near.by_move,
            weight=near.weight,
            root=root,
        ),
        seen=seen,
        misfit=seen.misfit(noise),
        steps=steps,
    )


def _stepped(inward_mm: np.ndarray, step_mm: np.ndarray) -> np.ndarray:
    """The displacement after a step, which is not too far."""
    far = FARTHEST_MM / max(float(np.abs(step_mm).max(initial=0.0)), 1e-12)
    return np.clip(inward_mm + min(1.0, far) * step_mm, *RANGE_MM)


@dataclass(frozen=True, kw_only=True, slots=True)
class _Near:
    """The quadratic that the cost is near a displacement."""

    matrix: Any
    """Half its second derivative, sparse (m, m)."""
    pull: np.ndarray
    """Half its fall, shape (m,)."""
    slopes: Slopes
    by_move: Any
    weight: np.ndarray
    """As `Linear` has them."""


@dataclass(frozen=True, kw_only=True)
class _Level:
    """The cost at one level."""

    patch: Patch
    priors: Priors
    stiffness: Any
    """R^T R of the priors, sparse (m, m)."""
    error_grey2: float
    """Variance that a pixel is given."""
    robust: bool
    """Whether blocks far off count less."""

    def cost(self, inward_mm: np.ndarray, seen: Prediction) -> float:
        """Of a displacement (m,) and what it would show."""
        told = (self._weight(seen) * seen.residual**2).sum()
        believed = self.stiffness @ inward_mm + self.priors.outward(inward_mm) * inward_mm
        return float(told + inward_mm @ believed)

    def near(self, inward_mm: np.ndarray, seen: Prediction) -> _Near:
        """The problem near a displacement (m,) and what it would show."""
        from scipy.sparse import diags

        slopes, weight = seen.slopes(), self._weight(seen)
        evidence = gathered(slopes, seen.residual, weight)
        products, pulls = on_tilts(self.patch.faces, self.patch.count, evidence)
        by_move = self.patch.tilt_slopes(seen.posed)
        outward = self.priors.outward(inward_mm)
        believed = self.stiffness @ inward_mm + outward * inward_mm
        return _Near(
            matrix=by_move.T @ (products @ by_move) + self.stiffness + diags(outward),
            pull=by_move.T @ pulls - believed,
            slopes=slopes,
            by_move=by_move,
            weight=weight,
        )

    def _weight(self, seen: Prediction) -> np.ndarray:
        """One over the variance of each block and colour, shape (P, 3)."""
        weight = seen.told / self.error_grey2
        if not self.robust:
            return weight
        over = np.abs(seen.residual) * np.sqrt(weight)
        return weight * np.minimum(1.0, HUBER / np.maximum(over, 1e-9))
