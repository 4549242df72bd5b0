"""Powers and colours of the lights, by non-negative least squares, and depths that go with them.

For each colour c the change of light in a press is linear in the lights' powers, and so is the
image at rest, with ambient light beside them:

    min over P >= 0 of  sum over presses w^2 (D(depth) P - (photo - idle))^2
                        + REST  sum over pixels at rest w^2 (B P + A ambient - idle)^2

in light, with w the slope of the display curve, so that errors count as grey levels do. Depths are
unknowns of their own: each is chosen anew for the powers, and the powers for the depths.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sim.optics.raster.display import light_of, shown
from workbench.calibration.light_basis import LightBasis, PressSamples
from workbench.calibration.seen.contact_circle import contact_shift
from workbench.calibration.seen.drift import CUT_OFF
from workbench.core.base.monitor import Monitor
from workbench.core.design.camera import ImageSensor

REST = 0.01
"""Weight of the image at rest against the presses, each over its number of samples [1]."""
ROUNDS = 200
"""Of powers and depths in turn, at most: they trade a little, so they settle slowly."""
SETTLED_MM = 2e-5
"""Change of every depth in a round at which they have settled [mm]."""
LEAST_SHARE = 0.01
"""Lights that give less than this of the strongest one's change are left out [1]."""
DARK = 2.0
"""Grey level below which a colour may have been cut off; above it is `drift.CUT_OFF`."""
RIDGE = 1e-6
"""Of the mean square of a light: lights beside each other are hard to tell apart [1]."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Powers:
    """What was fitted."""

    lights: np.ndarray
    """Display light per light's radiance, shape (3, L)."""
    ambient: np.ndarray
    """Shape (3,)."""
    depths_mm: np.ndarray
    """Of the presses, shape (J,)."""
    error_grey: float
    """Root mean square of what is left in the presses."""
    null_grey: float
    """The same if nothing changed."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Targets:
    """The photographs at the samples of a basis, in grey levels of rest's exposure."""

    idle: np.ndarray
    """At `LightBasis.rest_pixel`, shape (N, 3)."""
    presses: Sequence[tuple[np.ndarray, np.ndarray]]
    """Of each press the photograph and the image at rest at its samples, (N, 3) each."""


def fit_powers(
    basis: LightBasis,
    targets: Targets,
    sensor: ImageSensor,
    monitor: Monitor,
    *,
    depths_mm: np.ndarray | None = None,
    rest: float = REST,
) -> Powers:
    """Powers of all lights of a basis.

    Args:
        basis: The lights, each alone.
        targets: The photographs.
        sensor: Of the camera that took them.
        monitor: Progress and cancellation.
        depths_mm: Where depths begin, shape (J,); None begins in the middle of what is allowed.
        rest: Weight of the image at rest against the presses, each over its number of samples.
    """
    depths = [0.5 * (each.depths_mm[0] + each.depths_mm[-1]) for each in basis.presses]
    if depths_mm is not None:
        depths = list(depths_mm)
    change = [photo_change(photo, idle, sensor) for photo, idle in targets.presses]
    rest_square, rest_product = _rest_terms(basis, targets, sensor)
    samples = sum(len(each.pixel) for each in basis.presses)
    weight = rest * samples / max(len(basis.rest_pixel), 1)
    found, ambient = np.zeros((3, len(basis.lights))), np.zeros(3)
    for number in range(ROUNDS):
        monitor(number / ROUNDS, f"powers and depths, round {number + 1}")
        for colour in range(3):
            square, product = _press_terms(basis, depths, change, colour)
            square = np.pad(square, (0, 1)) + weight * rest_square[colour]
            product = np.append(product, 0.0) + weight * rest_product[colour]
            solved = _non_negative(square, product)
            found[colour], ambient[colour] = solved[:-1], solved[-1]
        before = list(depths)
        depths = [
            _best_depth(each, what, found) for each, what in zip(basis.presses, change, strict=True)
        ]
        if np.allclose(before, depths, atol=SETTLED_MM):
            break
    error, null = _errors(basis, depths, change, found)
    monitor(1.0, "powers and depths found")
    return Powers(
        lights=found,
        ambient=ambient,
        depths_mm=np.array(depths),
        error_grey=error,
        null_grey=null,
    )


def shifts_px(
    basis: LightBasis, targets: Targets, powers: Powers, sensor: ImageSensor, width_px: int
) -> np.ndarray:
    """How far each contact is from its circle, along columns and rows [px], shape (J, 2)."""
    found = []
    for samples, depth, (photo, idle) in zip(
        basis.presses, powers.depths_mm, targets.presses, strict=True
    ):
        row, column = samples.pixel // width_px, samples.pixel % width_px
        grid = len(np.unique(row)), len(np.unique(column))
        step = np.diff(np.unique(column))[:1].sum()
        light = light_of(np.clip(idle / 255.0, 0.0, 1.0), sensor)
        predicted = 255.0 * shown(light + samples.at(depth) @ powers.lights.T, sensor)
        usable = (photo < CUT_OFF) & (photo > DARK) & (predicted < CUT_OFF)
        shaped = [each.reshape(*grid, 3) for each in (predicted - idle, photo - idle, usable)]
        found.append(step * contact_shift(*shaped))
    return np.array(found)


def worth_keeping(basis: LightBasis, powers: Powers) -> np.ndarray:
    """Numbers of the lights that give a share of the change worth naming."""
    size = np.sqrt(
        np.mean(
            [
                (each.at(depth) ** 2).mean(axis=0)
                for each, depth in zip(basis.presses, powers.depths_mm, strict=True)
            ],
            axis=0,
        )
    )
    given = (powers.lights * size).max(axis=0)
    return np.flatnonzero(given >= LEAST_SHARE * given.max(initial=0.0))


@dataclass(frozen=True, kw_only=True, slots=True)
class Change:
    """What a press changed at its samples."""

    light: np.ndarray
    """Shape (N, 3)."""
    weight: np.ndarray
    """Grey levels per light, 0 where a colour may be cut off, shape (N, 3)."""


def photo_change(photo: np.ndarray, idle: np.ndarray, sensor: ImageSensor) -> Change:
    now, before = (light_of(np.clip(x / 255.0, 0.0, 1.0), sensor) for x in (photo, idle))
    usable = (photo < CUT_OFF) & (photo > DARK)
    return Change(light=now - before, weight=np.where(usable, grey_per_light(now, sensor), 0.0))


def grey_per_light(light: np.ndarray, sensor: ImageSensor) -> np.ndarray:
    """Grey levels per light of the display curve, not steeper than at 2 % of white."""
    at = np.clip(light, 0.02, 0.98)
    return 255.0 * (shown(at + 0.01, sensor) - shown(at - 0.01, sensor)) / 0.02


def _press_terms(
    basis: LightBasis, depths: Sequence[float], change: Sequence[Change], colour: int
) -> tuple[np.ndarray, np.ndarray]:
    """Square (L, L) and product (L,) of the normal equations of one colour."""
    count = len(basis.lights)
    square, product = np.zeros((count, count)), np.zeros(count)
    for samples, depth, what in zip(basis.presses, depths, change, strict=True):
        weight = what.weight[:, colour]
        rows = samples.at(depth) * weight[:, None]
        square += rows.T @ rows
        product += rows.T @ (weight * what.light[:, colour])
    return square, product


def _rest_terms(
    basis: LightBasis, targets: Targets, sensor: ImageSensor
) -> tuple[list[np.ndarray], list[np.ndarray]]:
    """The same of the image at rest, with ambient light as the last, for each colour."""
    light = light_of(targets.idle / 255.0, sensor)
    usable = (targets.idle < CUT_OFF) & (targets.idle > DARK) & (basis.ambient[:, None] > 0.0)
    weight = np.where(usable, grey_per_light(light, sensor), 0.0)
    whole = np.column_stack([basis.rest, basis.ambient]).astype(np.float64)
    squares, products = [], []
    for colour in range(3):
        rows = whole * weight[:, colour, None]
        squares.append(rows.T @ rows)
        products.append(rows.T @ (weight[:, colour] * light[:, colour]))
    return squares, products


def _non_negative(square: np.ndarray, product: np.ndarray) -> np.ndarray:
    """Non-negative least squares from normal equations; lights are scaled to like size."""
    from scipy.optimize import nnls

    size = np.sqrt(np.maximum(np.diag(square), 1e-300))
    scaled = square / size[:, None] / size[None, :] + RIDGE * np.eye(len(size))
    factor = np.linalg.cholesky(scaled)
    found, _ = nnls(factor.T, np.linalg.solve(factor, product / size), maxiter=50 * len(size))
    return found / size


def _best_depth(samples: PressSamples, what: Change, powers: np.ndarray) -> float:
    """Depth at which the press changes the light most as photographed [mm].

    Between two levels the change is linear in depth, so the least square is a closed form there.
    """
    levels = [((change @ powers.T) - what.light) * what.weight for change in samples.change]
    best, depth_mm = float((levels[0] ** 2).sum()), float(samples.depths_mm[0])
    for number, (low, high) in enumerate(itertools.pairwise(levels)):
        step = high - low
        share = -float((low * step).sum()) / max(float((step**2).sum()), 1e-30)
        share = min(max(share, 0.0), 1.0)
        error = float(((low + share * step) ** 2).sum())
        if error < best:
            best = error
            one, other = samples.depths_mm[number : number + 2]
            depth_mm = float(one + share * (other - one))
    return depth_mm


def _errors(
    basis: LightBasis, depths: Sequence[float], change: Sequence[Change], powers: np.ndarray
) -> tuple[float, float]:
    """Root mean squares in grey levels of what is left, and of the change itself."""
    left, whole, count = 0.0, 0.0, 0
    for samples, depth, what in zip(basis.presses, depths, change, strict=True):
        error = (samples.at(depth) @ powers.T - what.light) * what.weight
        left += float((error**2).sum())
        whole += float(((what.light * what.weight) ** 2).sum())
        count += int((what.weight > 0.0).sum())
    return float(np.sqrt(left / max(count, 1))), float(np.sqrt(whole / max(count, 1)))
