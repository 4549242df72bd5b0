"""What the photographs say of each unknown, in numbers and words.

The covariance after the fit stands against the priors. An unknown is determined where twice its
standard deviation is below what is worth knowing of it. Where it is not, the unknowns that it goes
with, by correlation, say why: photographs see only some combination. The singular values are those
of the residuals' derivatives, each over its standard deviation, by the unknowns over their priors:
a direction of 1 is as well known from the photographs as it was before, below it hardly at all.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from workbench.calibration.derivatives import Fit
from workbench.calibration.refine import Refined

POWER_WANTED = 0.03
"""Of the power of a light over the mean of all [1]."""
TOGETHER = 0.6
"""Correlation from which two unknowns are said to go together [1]."""
NAMED = 3
"""Unknowns that are named of a direction or as companions, at most."""
OF_LARGEST = 0.4
"""Part in a direction over the largest from which an unknown is named [1]."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Parameter:
    """One unknown after the fit."""

    name: str
    unit: str
    value: float
    """What is added to the design's; of a power the power over the mean of all lights."""
    sd: float
    prior_sd: float | None
    determined: bool
    words: str


@dataclass(frozen=True, kw_only=True, slots=True)
class Direction:
    """A combination of unknowns, over their priors, that the photographs see as one."""

    singular_value: float
    parts: tuple[tuple[str, float], ...]
    """Names and parts of a unit vector, the largest first."""


def parameters(found: Refined) -> tuple[Parameter, ...]:
    """Every unknown, and the power of each light."""
    count = len(found.among)
    shares, by_value = _relative_powers(found.fit, found.active)
    first = found.covariance.shape[0] - len(found.active)
    chosen = np.zeros((count + len(shares), found.covariance.shape[0]))
    chosen[:count, :count] = np.eye(count)
    chosen[count:, first:] = by_value
    covariance = chosen @ found.covariance @ chosen.T
    sd = np.sqrt(np.maximum(np.diag(covariance), 0.0))
    names = [each.name for each in found.among]
    names += [f"power of light {number + 1}" for number in range(len(shares))]
    values = [*found.fit.values, *shares]
    wanted = [each.wanted for each in found.among] + [POWER_WANTED] * len(shares)
    units = [each.unit for each in found.among] + [""] * len(shares)
    result = []
    for k, name in enumerate(names):
        if k >= count and values[k] <= 0.0:
            # A light that does not shine has no power to be known.
            continue
        determined = bool(2.0 * sd[k] <= wanted[k])
        prior_sd = found.among[k].prior_sd if k < count else None
        likeness = covariance[k] / np.maximum(sd * sd[k], 1e-300)
        likeness[k] = 0.0
        result.append(
            Parameter(
                name=name,
                unit=units[k],
                value=float(values[k]),
                sd=float(sd[k]),
                prior_sd=prior_sd,
                determined=determined,
                words="" if determined else _words(names, likeness, sd[k], (units[k], prior_sd)),
            )
        )
    return tuple(result)


def _words(names: list[str], likeness: np.ndarray, sd: float, of: tuple[str, float | None]) -> str:
    """How well an unknown is known that is not determined, and what it goes with."""
    unit, prior_sd = of
    text = f"known to {sd:.2g} {unit}".rstrip()
    if prior_sd is not None and sd > 0.9 * prior_sd:
        return f"{text}, no better than before"
    order = np.argsort(-np.abs(likeness))
    others = [names[k] for k in order[:NAMED] if abs(likeness[k]) >= TOGETHER]
    return f"{text}, trades with {', '.join(others)}" if others else f"{text} only"


def directions(found: Refined) -> tuple[Direction, ...]:
    """All directions of the unknowns, the best seen first."""
    count = len(found.among)
    prior = np.array([each.prior_sd for each in found.among])
    posterior = found.covariance[:count, :count] / np.outer(prior, prior)
    left, vectors = np.linalg.eigh(posterior)
    result = []
    for share, vector in zip(left, vectors.T, strict=True):
        # Of a direction, 1 / variance after = 1 / variance before + singular value^2.
        singular = float(np.sqrt(max(1.0 / max(share, 1e-12) - 1.0, 0.0)))
        order = np.argsort(-np.abs(vector))[:NAMED]
        parts = tuple(
            (found.among[k].name, float(vector[k]))
            for k in order
            if abs(vector[k]) >= OF_LARGEST * abs(vector[order[0]])
        )
        result.append(Direction(singular_value=singular, parts=parts))
    return tuple(result)


def _relative_powers(fit: Fit, active: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Power of each light over the mean, (L,), and its derivatives by the active powers, (L, P)."""
    powers = fit.powers.lights.sum(axis=0)
    mean = float(powers.mean())
    shares = powers / mean
    by_value = np.zeros((len(powers), len(active)))
    for number, (_, light) in enumerate(active):
        if light < len(powers):
            by_value[:, number] -= shares / (len(powers) * mean)
            by_value[light, number] += 1.0 / mean
    return shares, by_value
