"""How a condensed skin hardens: the numbers that fit its forces to presses of another solver.

Linear elasticity at rest is 17 % too soft a quarter of the wall deep and 40 % at half of it: rubber
hardens and the wall thins. Both grow with the indentation over the wall, s; edges press locally
harder than balls. All of it enters forces only, displacements stay as solved.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from workbench.core.result.condensed import Hardening

TANGENTIAL_WEIGHT = 0.5
"""Of the tangential force over its peak, beside the normal force's relative error."""
FIRST = 1
"""Frames left out at first touch: a few nodes carry them, and the other solver is less exact."""


@dataclass(frozen=True, kw_only=True, slots=True)
class PlayedFrame:
    """Nodal forces of one frame as solved, before they are hardened."""

    s: np.ndarray
    """Indentation over the wall of the m nodes that touch, shape (m,)."""
    deep_N: np.ndarray
    """Part of the force on the skin along its normal, shape (m, 3)."""
    side_N: np.ndarray
    """The rest, shape (m, 3)."""
    slides: np.ndarray
    """Which slide, shape (m,), bool."""


@dataclass(frozen=True, kw_only=True, slots=True)
class PlayedPress:
    """A press by both solvers."""

    name: str
    frames: Sequence[PlayedFrame]
    """K of them."""
    reaction_N: np.ndarray
    """Force on the object that the other solver found, shape (K, 3)."""
    normal: np.ndarray
    """Outward normal of the target, shape (3,)."""
    sharpness: float
    """Of the object."""


def sharpness(least_radius_mm: float, wall_mm: float) -> float:
    """1 for an edge, 0 for what is as blunt as the wall is thick."""
    return float(np.clip(1.0 - least_radius_mm / wall_mm, 0.0, 1.0))


def factor(s: np.ndarray, numbers: Sequence[float], sharp: float) -> np.ndarray:
    """(1 + a s + b s^2) (1 + c e) at indentations over the wall, shape as s."""
    a, b, c = numbers
    return (1.0 + a * s + b * s * s) * (1.0 + c * sharp)


def reaction_N(press: PlayedPress, law: Hardening) -> np.ndarray:
    """Force on the object with hardened forces, shape (K, 3)."""
    found = np.zeros((len(press.frames), 3))
    for number, frame in enumerate(press.frames):
        s = np.minimum(frame.s, law.deepest)
        normal = factor(s, law.normal, press.sharpness)
        side = np.where(frame.slides, normal, factor(s, law.tangential, press.sharpness))
        found[number] = -(normal @ frame.deep_N + side @ frame.side_N)
    return found


def residuals(press: PlayedPress, law: Hardening) -> tuple[np.ndarray, np.ndarray]:
    """Errors of a press, both of shape (K,): of the normal force over itself, and of the
    tangential force over its largest (zero where there is none)."""
    found = reaction_N(press, law)
    along, wanted = found @ press.normal, press.reaction_N @ press.normal
    across = np.linalg.norm(found - np.outer(along, press.normal), axis=1)
    side = np.linalg.norm(press.reaction_N - np.outer(wanted, press.normal), axis=1)
    # Without shear, what little there is across is no measure of anything.
    peak = side.max() if side.max() > 0.02 * wanted.max() else np.inf
    return along / wanted - 1.0, (across - side) / peak


def fit(presses: Sequence[PlayedPress]) -> Hardening:
    """The law that fits presses best, by least squares, and its largest error in each."""
    from scipy.optimize import least_squares

    deepest = max(float(frame.s.max(initial=0.0)) for press in presses for frame in press.frames)
    sharp = {press.sharpness for press in presses}

    def law(numbers: np.ndarray) -> Hardening:
        a, b, c, d, f = numbers.tolist()
        # One sharpness cannot tell what it changes.
        c, f = (c, f) if len(sharp) > 1 else (0.0, 0.0)
        # Presses are sheared at one depth, which tells no curve.
        return Hardening(normal=(a, b, c), tangential=(d, 0.0, f), deepest=deepest)

    def cost(numbers: np.ndarray) -> np.ndarray:
        errors = []
        for press in presses:
            normal, across = residuals(press, law(numbers))
            errors += [normal[FIRST:], TANGENTIAL_WEIGHT * across[FIRST:]]
        return np.concatenate(errors)

    # A wall that thins never gives way more: the normal curve rises from where it starts.
    least = [0.0, 0.0, *[-np.inf] * 3]
    found = law(least_squares(cost, [0.5, 1.5, 0.0, 0.0, 0.0], bounds=(least, np.inf)).x)
    errors = {
        press.name: float(np.abs(residuals(press, found)[0][FIRST:]).max()) for press in presses
    }
    return Hardening(
        normal=found.normal, tangential=found.tangential, deepest=deepest, errors=errors
    )
