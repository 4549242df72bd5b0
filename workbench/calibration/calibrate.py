"""From photographs of a built sensor to a calibrated design, its unit, and what each predicts.

    circles     given, or found in the difference from rest
    drift       of exposure and white balance, from untouched skin
    places      of the contacts on the skin, by the camera of the design
    presses     of each ball by the contact solver, over the depths that the circle allows
    powers      and colours of the lights, with the depths as unknowns
    residual    of slope and place, over that
    predictions of every photograph; held-out ones from place and depth alone

Everything long is a stage of the store: a calibration that is stopped goes on where it was.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sim.optics.studio.unit_residual import unit_bytes
from workbench.calibration.ball_presses import BallPress, carried, press_balls
from workbench.calibration.contact_circle import find_circle
from workbench.calibration.contact_shift import MOST
from workbench.calibration.drift import CUT_OFF, Drift, measured_drift, untouched
from workbench.calibration.fitted_design import fitted_design, with_unit
from workbench.calibration.light_basis import LightBasis, open_basis
from workbench.calibration.light_sources import candidates, single_lights
from workbench.calibration.photo_set import IDLE, BallPhoto, Circle, PhotoSet
from workbench.calibration.powers import Powers, Targets, fit_powers, shifts_px, worth_keeping
from workbench.calibration.predictions import Predictions, predict
from workbench.calibration.residual import REACH, fit_residual
from workbench.calibration.seen_places import SeenPlaces
from workbench.calibration.stored import stored
from workbench.core.base.errors import DesignError
from workbench.core.base.monitor import Monitor, part
from workbench.core.design.design import SensorDesign
from workbench.core.design.unit import unit
from workbench.core.press.press_case import PressCase
from workbench.core.result.results import MembraneMesh
from workbench.pipeline.store import Store

NO_RESIDUAL = np.zeros((0, 4)), np.zeros((0, 3))
BADLY = 0.5
"""Share of the change that lights leave unexplained from which they are not those of the sensor
[1], by root mean squares: lights in other places leave .6 to .9, the right ones .2 to .4."""


@dataclass(frozen=True, kw_only=True, slots=True)
class SeenPhoto:
    """A photograph with what was found in it."""

    photo: BallPhoto
    circle: Circle
    drift: Drift

    @property
    def at_rest(self) -> np.ndarray:
        """Grey levels at rest's exposure, shape (H, W, 3), float64."""
        return self.drift.taken_back(self.photo.image)


@dataclass(frozen=True, kw_only=True, slots=True)
class Calibration:
    """What a calibration gives."""

    design: SensorDesign
    """In the fitted light, without its unit."""
    unit_data: bytes
    """The unit's file."""
    known: bool
    """Whether the design's own lights were fitted, rather than candidates around it."""
    basis: LightBasis
    """Of the lights that were kept."""
    powers: Powers
    seen: tuple[SeenPhoto, ...]
    presses: tuple[BallPress, ...]
    """Of all photographs, in the order of `seen`."""
    depths_mm: tuple[float, ...]
    rest: np.ndarray
    """The sensor at rest in the fitted light alone, shape (H, W, 3), uint8."""
    by_light: Predictions
    """In the fitted light over the photograph at rest, without the residual."""
    predictions: Predictions
    """With the residual."""


def calibrate(
    design: SensorDesign, photos: PhotoSet, store: Store, *, lights: str, monitor: Monitor
) -> Calibration:
    """Fit a design's light to photographs.

    Args:
        design: Its camera must have the photographs' size.
        photos: At rest, and of balls.
        store: Keeps presses and light.
        lights: `known`: those of the design; `unknown`: candidates around the body; `auto`: the
            first if they explain the photographs, else the second.
        monitor: Progress and cancellation.

    Raises:
        DesignError: With a photograph's name, if it cannot be used.
        WorkbenchError: From the stages.
    """
    _expect_size(design, photos)
    seen = [_seen(photo, photos.idle) for photo in photos.photos]
    mesh: MembraneMesh = stored(design, PressCase(), "mesh", store, part(monitor, 0.0, 0.05))
    places = SeenPlaces(mesh, design.optics)
    located = [(each.photo, places.place(each.circle, each.photo.name)) for each in seen]
    presses = press_balls(design, places, located, store, part(monitor, 0.05, 0.45))
    fitted = [k for k, each in enumerate(seen) if not each.photo.held_out]
    of_fitted = [(presses[k], seen[k].circle) for k in fitted]
    targets = [seen[k] for k in fitted]
    known, sensor = lights != "unknown", design.optics.camera.sensor
    found = None
    if known:
        span = part(monitor, 0.45, 0.55)
        sources = single_lights(design.optics)
        basis = open_basis(design, mesh, sources, of_fitted, store, span)
        found = fit_powers(basis, _targets(basis, targets, photos), sensor, span)
    if found is None or (lights == "auto" and found.error_grey > BADLY * found.null_grey):
        known, span = False, part(monitor, 0.55, 0.7)
        basis = open_basis(design, mesh, candidates(mesh), of_fitted, store, span)
        found = fit_powers(basis, _targets(basis, targets, photos), sensor, span)
        basis = basis.only(worth_keeping(basis, found))
        found = fit_powers(basis, _targets(basis, targets, photos), sensor, span)
    # Where each contact is in its photograph is known better now than its circle said.
    away = shifts_px(basis, _targets(basis, targets, photos), found, sensor, photos.idle.shape[1])
    # Held-out photographs share what is common to all: how circles are drawn or found here.
    shifts = dict.fromkeys(range(len(seen)), np.median(away, axis=0))
    shifts.update(zip(fitted, away, strict=True))
    for number, shift in shifts.items():
        seen[number] = _shifted(seen[number], shift, photos.idle)
        place = places.place(seen[number].circle, seen[number].photo.name)
        presses[number] = carried(presses[number], seen[number].photo, place, mesh)
    of_fitted = [(presses[k], seen[k].circle) for k in fitted]
    targets, span = [seen[k] for k in fitted], part(monitor, 0.7, 0.85)
    basis = open_basis(design, mesh, basis.lights, of_fitted, store, span)
    found = fit_powers(basis, _targets(basis, targets, photos), sensor, span)
    calibrated = fitted_design(design, basis.lights, found, known=known)
    depths = _depths(presses, fitted, found)
    moved = [press.displaced_mm(depth) for press, depth in zip(presses, depths, strict=True)]
    bare = unit("unit.npz", unit_bytes(photos.idle_png, *NO_RESIDUAL, REACH))
    span = part(monitor, 0.85, 0.92)
    first = predict(with_unit(calibrated, bare), mesh, store, moved, span)
    centres, weights = _residual(first, seen, fitted)
    data = unit_bytes(photos.idle_png, centres, weights, REACH)
    whole = with_unit(calibrated, unit("unit.npz", data))
    return Calibration(
        design=calibrated,
        unit_data=data,
        known=known,
        basis=basis,
        powers=found,
        seen=tuple(seen),
        presses=tuple(presses),
        depths_mm=tuple(depths),
        rest=predict(calibrated, mesh, store, moved[:1], part(monitor, 0.92, 0.95)).rest,
        by_light=first,
        predictions=predict(whole, mesh, store, moved, part(monitor, 0.95, 1.0)),
    )


def _expect_size(design: SensorDesign, photos: PhotoSet) -> None:
    camera, (height, width) = design.optics.camera, photos.idle.shape[:2]
    if (width, height) != (camera.width_px, camera.height_px):
        raise DesignError(
            f"{IDLE} has {width} x {height} pixels, the camera of the design "
            f"{camera.width_px} x {camera.height_px}",
            hint=f"set optics.camera.width_px = {width} and height_px = {height}, and the field of "
            "view that goes with them",
            at="optics.camera.width_px",
        )


def _seen(photo: BallPhoto, idle: np.ndarray) -> SeenPhoto:
    """Where the contact is and how the exposure drifted: each is looked for without the other."""
    circle = photo.circle
    if circle is None:
        circle = find_circle(photo.image.astype(np.float64) - idle, photo.name)
    drift = measured_drift(photo.image, idle, circle)
    if photo.circle is None:
        circle = find_circle(drift.taken_back(photo.image) - idle, photo.name)
        drift = measured_drift(photo.image, idle, circle)
    return SeenPhoto(photo=photo, circle=circle, drift=drift)


def _shifted(seen: SeenPhoto, shift_px: np.ndarray, idle: np.ndarray) -> SeenPhoto:
    """A photograph with its contact elsewhere, if that is the same contact."""
    circle, (height, width) = seen.circle, idle.shape[:2]
    if not np.hypot(*shift_px) <= MOST * circle.radius_px:
        return seen
    moved = Circle(
        column_px=float(np.clip(circle.column_px + shift_px[0], 0, width - 1)),
        row_px=float(np.clip(circle.row_px + shift_px[1], 0, height - 1)),
        radius_px=circle.radius_px,
    )
    drift = measured_drift(seen.photo.image, idle, moved)
    return SeenPhoto(photo=seen.photo, circle=moved, drift=drift)


def _targets(basis: LightBasis, seen: Sequence[SeenPhoto], photos: PhotoSet) -> Targets:
    """The photographs at the samples of a basis."""
    idle = photos.idle.reshape(-1, 3).astype(np.float64)
    return Targets(
        idle=idle[basis.rest_pixel],
        presses=[
            (each.at_rest.reshape(-1, 3)[samples.pixel], idle[samples.pixel])
            for each, samples in zip(seen, basis.presses, strict=True)
        ],
    )


def _depths(presses: Sequence[BallPress], fitted: Sequence[int], powers: Powers) -> list[float]:
    """Depth of every press [mm]: fitted, given, or from the circle as the fitted ones say.

    A held-out photograph tells its circle alone. How the depths that were fitted go with Hertz's of
    their circles is a line, whose slope, by regression, is the less the more the circles scatter.
    """
    guesses = np.array([presses[k].guess_mm for k in fitted])
    spread = guesses - guesses.mean()
    together = float(spread @ (powers.depths_mm - powers.depths_mm.mean()))
    slope = np.clip(together / max(float(spread @ spread), 1e-12), 0.0, 1.5)
    mean = float(powers.depths_mm.mean())
    found = [
        float(np.clip(mean + slope * (each.guess_mm - guesses.mean()), each.least_mm, each.most_mm))
        for each in presses
    ]
    for number, depth in zip(fitted, powers.depths_mm, strict=True):
        found[number] = float(depth)
    return found


def _residual(
    first: Predictions, seen: Sequence[SeenPhoto], fitted: Sequence[int]
) -> tuple[np.ndarray, np.ndarray]:
    """Centres and weights of what the light leaves in the fitted photographs."""
    left, usable = [], []
    for number in fitted:
        pixel = first.slopes[number].pixel
        predicted = first.images[number].reshape(-1, 3)[pixel].astype(np.float64)
        taken = seen[number].at_rest.reshape(-1, 3)[pixel]
        raw = seen[number].photo.image.reshape(-1, 3)[pixel]
        near = ~untouched(seen[number].photo.image.shape, seen[number].circle).reshape(-1)[pixel]
        left.append(taken - predicted)
        usable.append(near & ((raw < CUT_OFF) & (predicted < CUT_OFF)).all(axis=1))
    return fit_residual([first.slopes[number] for number in fitted], left, usable)
