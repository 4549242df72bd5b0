"""Camera, places of the lights, lobe, coating and fall-off by Gauss-Newton, powers eliminated.

For each set of values the lights are traced alone and drawn, and powers, colours and depths are
those that fit best (variable projection; Golub and Pereyra, SIAM J. Numer. Anal. 10 (1973) 413).

Circles move with the photographs: where a contact is on the skin follows from its circle and the
camera, and the circle is an unknown as well. A step is taken if the error falls, else half of it.
Everything that is traced is a stage of the store.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from workbench.calibration.derivatives import Fit, Task, placed, slopes_of
from workbench.calibration.gauss_newton import Normal, normal_equations
from workbench.calibration.known_places import place_misfit, place_rows
from workbench.calibration.light_basis import LightBasis, open_basis
from workbench.calibration.photo_rows import (
    Slopes,
    Whitening,
    active_powers,
    image_rows,
    misfit,
    press_error,
    residuals,
    whitening,
)
from workbench.calibration.powers import Powers, fit_powers
from workbench.calibration.seen.photo_set import Circle
from workbench.calibration.unknowns import Unknown, moved_scene
from workbench.core.base.monitor import Monitor, part

ROUNDS = 2
"""Times that all derivatives are taken."""
STEPS = 3
"""Steps with the same derivatives."""
HALVES = 2
"""Times that a step is halved before it is given up."""
ENOUGH = 0.1
"""Largest change of an unknown over its prior's deviation at which all have settled [1]."""
POLISHES = 3
FIXED = 1e-9
"""Standard deviation before of what stays as it is."""
CIRCLE_SD = 0.1
"""Of a circle's middle over its radius [1]: circles are found or drawn that well."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Refined:
    """What Gauss-Newton found, with its covariance."""

    fit: Fit
    among: tuple[Unknown, ...]
    covariance: np.ndarray
    """Of unknowns, depths, shifts along columns and rows, powers, as `photo_rows` counts them."""
    active: np.ndarray
    """Colour and light of each power in it, shape (P, 2)."""
    steps: int


def refine(task: Task, first: Fit, monitor: Monitor) -> Refined:
    """Fit all unknowns, from `first` at value 0.

    Raises:
        WorkbenchError: From the stages that trace.
    """
    fit, steps, slopes = first, 0, []
    for number in range(ROUNDS):
        span = part(monitor, number / ROUNDS, (number + 1) / ROUNDS)
        slopes = slopes_of(task, fit, part(span, 0.0, 0.5))
        before = fit.values
        for step in range(STEPS):
            over = whitening(task.images, residuals(task.images, fit.basis, fit.powers))
            turn = part(span, 0.5 + 0.5 * step / STEPS, 0.5 + 0.5 * (step + 1) / STEPS)
            better = _step(task, fit, _normal(task, fit, slopes, over), over, turn)
            if better is None:
                break
            last, fit, steps = fit.values, better, steps + 1
            if _settled(task, last, fit.values):
                break
        if _settled(task, before, fit.values):
            break
    # The last derivatives were taken near enough for the covariance.
    over = whitening(task.images, residuals(task.images, fit.basis, fit.powers))
    monitor(1.0, "camera, lights and coating fitted")
    return Refined(
        fit=fit,
        among=task.among,
        covariance=_normal(task, fit, slopes, over).covariance(),
        active=active_powers(fit.powers),
        steps=steps,
    )


def _settled(task: Task, before: np.ndarray, now: np.ndarray) -> bool:
    sizes = np.array([each.prior_sd for each in task.among])
    return bool((np.abs(now - before) < ENOUGH * sizes).all())


def _normal(task: Task, fit: Fit, slopes: Sequence[Slopes], over: Whitening) -> Normal:
    rows = image_rows(task.images, (fit.basis, fit.powers), slopes, over)
    rows += place_rows(task, fit, slopes)
    spans = [max(each.most_mm - each.least_mm, 1e-6) for each in task.presses]
    count, powers = len(spans), len(active_powers(fit.powers))
    circles = np.array([CIRCLE_SD * each.radius_px for each in task.boxes])
    now = np.concatenate([fit.values, np.zeros(count), *shifts_of(task, fit).T, np.zeros(powers)])
    prior_sd = np.concatenate(
        [
            [each.prior_sd for each in task.among],
            spans,
            circles,
            circles,
            np.full(powers, np.inf),
        ]
    )
    return normal_equations(rows, now, prior_sd)


def shifts_of(task: Task, fit: Fit) -> np.ndarray:
    """How far circles are from their boxes' middles [px], shape (J, 2)."""
    return np.array(
        [
            (now.column_px - box.column_px, now.row_px - box.row_px)
            for now, box in zip(fit.circles, task.boxes, strict=True)
        ]
    ).reshape(-1, 2)


def _error(task: Task, fit: Fit, over: Whitening) -> float:
    """Sum of squares over their variances, with what is off the priors' means."""
    left = residuals(task.images, fit.basis, fit.powers)
    sizes = np.array([each.prior_sd for each in task.among])
    circles = np.array([CIRCLE_SD * each.radius_px for each in task.boxes])
    off = float(((fit.values / sizes) ** 2).sum())
    off += float(((shifts_of(task, fit) / circles[:, None]) ** 2).sum())
    return misfit(task.images, left, over) + place_misfit(task, fit) + off


def _step(task: Task, fit: Fit, normal: Normal, over: Whitening, monitor: Monitor) -> Fit | None:
    """The fit after a step, or half of it, that makes the error less; None if none does."""
    whole, error = normal.step(), _error(task, fit, over)
    count, presses = len(task.among), len(task.presses)
    for number in range(HALVES + 1):
        share = 0.5**number
        step = share * whole
        span = part(monitor, number / (HALVES + 1), (number + 1) / (HALVES + 1))
        span(0.0, f"a step{' half as far' * bool(number)}")
        values = fit.values + step[:count]
        depths_mm = fit.powers.depths_mm + step[count : count + presses]
        moved = step[count + presses : count + 3 * presses].reshape(2, presses).T
        trial = _fitted(task, values, (fit.circles, moved), depths_mm, (over, span))
        if _error(task, trial, over) < error:
            return trial
    return None


def _fitted(
    task: Task,
    values: np.ndarray,
    circles: tuple[Sequence[Circle], np.ndarray],
    depths_mm: np.ndarray,
    over: tuple[Whitening, Monitor],
) -> Fit:
    """Light at some values, with the powers and depths that fit best."""
    scene, values = moved_scene(task.scene, task.among, values, task.mesh)
    camera = scene.camera
    limits = np.array([camera.width_px - 1.0, camera.height_px - 1.0])
    seen = []
    for circle, moved in zip(*circles, strict=True):
        column, row = np.clip(np.array([circle.column_px, circle.row_px]) + moved, 0.0, limits)
        seen.append(dataclasses.replace(circle, column_px=float(column), row_px=float(row)))
    presses = placed(task, scene, task.presses, seen)
    whitened, monitor = over
    basis = open_basis(
        scene.of(task.design), task.mesh, scene.lights, presses, task.store, part(monitor, 0.0, 0.9)
    )
    low, high = np.array([(each.least_mm, each.most_mm) for each in task.presses]).T
    powers = fit_powers(
        basis,
        task.targets,
        camera.sensor,
        part(monitor, 0.9, 1.0),
        depths_mm=np.clip(depths_mm, low, high),
        rest=_rest_weight(task, basis, whitened),
    )
    powers = _polished(task, basis, powers, whitened)
    return Fit(values=values, scene=scene, circles=tuple(seen), basis=basis, powers=powers)


def _rest_weight(task: Task, basis: LightBasis, over: Whitening) -> float:
    """Weight of the image at rest in `fit_powers` that goes with the variances."""
    samples = sum(len(each.pixel) for each in basis.presses)
    return len(basis.rest_pixel) / max(samples, 1) * (over.press / over.rest) ** 2


def _polished(task: Task, basis: LightBasis, powers: Powers, over: Whitening) -> Powers:
    """Powers and depths that fit best with the same weights."""
    count = len(task.presses)
    low, high = np.array([(each.least_mm, each.most_mm) for each in task.presses]).T
    error = misfit(task.images, residuals(task.images, basis, powers), over)
    for _ in range(POLISHES):
        active = active_powers(powers)
        rows = image_rows(task.images, (basis, powers), [], over)
        sizes = np.concatenate(
            [np.maximum(high - low, FIXED), np.full(2 * count, FIXED), np.full(len(active), np.inf)]
        )
        step = normal_equations(rows, np.zeros(len(sizes)), sizes).step()
        whole = np.column_stack([powers.lights, powers.ambient])
        whole[tuple(active.T)] = np.maximum(whole[tuple(active.T)] + step[3 * count :], 0.0)
        trial = dataclasses.replace(
            powers,
            lights=whole[:, :-1],
            ambient=whole[:, -1],
            depths_mm=np.clip(powers.depths_mm + step[:count], low, high),
        )
        now = misfit(task.images, residuals(task.images, basis, trial), over)
        if not now < error:
            break
        powers, error = trial, now
    return dataclasses.replace(powers, error_grey=press_error(task.images, basis, powers))
