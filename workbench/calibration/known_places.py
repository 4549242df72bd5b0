"""Places where balls were pressed, as the stage that pressed them knows them.

A contact's circle and the camera give a place on the skin; a stage that was set to zero on the
sensor gives another. Where both are known their difference tells where the camera stands, which
nothing else in the photographs tells as well. It is taken along the skin: how deep the ball went is
another unknown. A stage errs by itself in each place, and in all of them by where its zero is and
by how its axes are turned against the sensor's, so with tangents T of all places and their moments
R about the origin the differences have the covariance

    C = s^2 I + z^2 T T' + a^2 R R',

and count as rows of the Gauss-Newton fit after division by its Cholesky factor.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence

import numpy as np

from workbench.calibration.ball_presses import BallPress
from workbench.calibration.derivatives import Fit, Task, placed, points_mm
from workbench.calibration.gauss_newton import Rows
from workbench.calibration.photo_rows import Slopes
from workbench.core.base.frames import tangent
from workbench.core.base.units import radians

EACH_MM, ZERO_MM, TURN_DEG = 0.05, 0.1, 0.3
"""Standard deviations: of one place, of the stage's zero along each axis, of its turn about each.
Our choice: the stage of a hobby printer, its zero found by touching the sensor from its sides and
from above, and its axes laid along the sensor's by eye."""
STEP_PX = 1.0
"""Of differences by the shift of a circle."""


def place_misfit(task: Task, fit: Fit) -> float:
    """Sum of the squares over their variances of what circles and stage differ by."""
    if not _known(task):
        return 0.0
    return float(((_over(task) @ _away(task, _seen_mm(task, fit))) ** 2).sum())


def place_rows(task: Task, fit: Fit, slopes: Sequence[Slopes]) -> list[Rows]:
    """Those differences over their deviations, with all derivatives; none if no place is known.

    Values are counted as in `workbench.calibration.photo_rows`.
    """
    known = _known(task)
    if not known:
        return []
    count, presses = len(slopes), len(task.presses)
    now = _seen_mm(task, fit)
    columns = [_along(task, each.places_mm) for each in slopes]
    values = list(range(count))
    for axis in range(2):
        by_px = (_seen_mm(task, fit, axis) - now) / STEP_PX
        for k in known:
            own = np.zeros_like(by_px)
            own[k] = by_px[k]
            columns.append(_along(task, own))
            values.append(count + (1 + axis) * presses + k)
    over = _over(task)
    return [
        Rows(
            residual=over @ _away(task, now),
            slope=over @ np.column_stack(columns),
            value=np.array(values),
        )
    ]


def apart_mm(presses: Sequence[BallPress]) -> np.ndarray:
    """Along the skin from where a stage was to where the contact is seen, of all that it knows."""
    found = []
    for press in presses:
        if press.photo.place_mm is not None:
            away, normal = press.photo.place_mm - press.place.point_mm, press.place.normal
            found.append(np.linalg.norm(away - (away @ normal) * normal))
    return np.array(found, dtype=np.float64)


def _known(task: Task) -> list[int]:
    """Numbers of the fitted photographs whose places are known: K of them."""
    return [k for k, each in enumerate(task.presses) if each.photo.place_mm is not None]


def _seen_mm(task: Task, fit: Fit, axis: int | None = None) -> np.ndarray:
    """Where the camera sees the circles, or each a step along columns or rows on, (J, 3)."""
    shift = np.zeros(2) if axis is None else STEP_PX * np.eye(2)[axis]
    circles = [
        dataclasses.replace(
            each, column_px=each.column_px + shift[0], row_px=each.row_px + shift[1]
        )
        for each in fit.circles
    ]
    return points_mm(placed(task, fit.scene, task.presses, circles))


def _tangents(task: Task) -> np.ndarray:
    """Two directions along the skin at each known place, shape (K, 2, 3)."""
    found = []
    for k in _known(task):
        normal = task.presses[k].place.normal
        side = tangent(normal)
        found.append(np.stack([side, np.cross(normal, side)]))
    return np.array(found)


def _along(task: Task, vectors: np.ndarray) -> np.ndarray:
    """Vectors of all presses (J, 3) along the skin at the known places, shape (2 K,)."""
    return np.einsum("kad,kd->ka", _tangents(task), vectors[_known(task)]).ravel()


def _away(task: Task, seen_mm: np.ndarray) -> np.ndarray:
    """From where the stage was to where the camera sees the contacts, (2 K,)."""
    told = seen_mm.copy()
    for k in _known(task):
        told[k] = task.presses[k].photo.place_mm
    return _along(task, seen_mm - told)


def _over(task: Task) -> np.ndarray:
    """What differences are multiplied by to be independent and of variance 1, (2 K, 2 K)."""
    sides = _tangents(task)
    places = np.array([task.presses[k].photo.place_mm for k in _known(task)])
    # A turn w moves a place r by w x r, along a tangent t by w . (r x t).
    moments = np.cross(places[:, None], sides).reshape(-1, 3)
    flat = sides.reshape(-1, 3)
    covariance = EACH_MM**2 * np.eye(len(flat)) + ZERO_MM**2 * flat @ flat.T
    covariance += radians(TURN_DEG) ** 2 * moments @ moments.T
    return np.linalg.inv(np.linalg.cholesky(covariance))
