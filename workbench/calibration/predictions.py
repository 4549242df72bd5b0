"""What the calibrated design shows of each press, at what depth, and what it leaves.

Images come through the same studio as every other.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sim.optics.studio.unit_residual import places, slopes
from workbench.calibration.ball_presses import BallPress
from workbench.calibration.residual import Slopes, fit_residual
from workbench.calibration.seen.drift import CUT_OFF, SeenPhoto, untouched
from workbench.calibration.stored import lit_studio
from workbench.core.base.monitor import Monitor, part
from workbench.core.design.design import SensorDesign
from workbench.core.result.results import MembraneMesh
from workbench.pipeline.store import Store


@dataclass(frozen=True, kw_only=True, slots=True)
class Predictions:
    """Images at rest's exposure."""

    rest: np.ndarray
    """At rest, shape (H, W, 3), uint8: the photograph where the design has a unit."""
    images: tuple[np.ndarray, ...]
    """Of each press, (H, W, 3), uint8."""
    slopes: tuple[Slopes, ...]
    """Of each press, where it changed the image."""


def predict(
    design: SensorDesign,
    mesh: MembraneMesh,
    store: Store,
    moved: Sequence[np.ndarray],
    monitor: Monitor,
) -> Predictions:
    """Images of displaced skins, (V, 3) each.

    Raises:
        WorkbenchError: From the stages that trace.
    """
    optics = design.optics
    studio = lit_studio(design, mesh, store, part(monitor, 0.0, 0.7), "calibrated light")
    images, tilts, rest = [], [], np.zeros(0)
    for number, displaced in enumerate(moved):
        monitor(0.7 + 0.3 * number / len(moved), f"prediction {number + 1} of {len(moved)}")
        frames = studio.shoot(displaced[None])
        rest = frames.rgb[0]
        images.append(frames.rgb[1])
        pixel = np.flatnonzero(frames.moved[1].reshape(-1))
        normal, still = (frames.normal[k].reshape(-1, 3)[pixel].astype(np.float32) for k in (1, 0))
        known = np.isfinite(normal).all(axis=1) & normal.any(axis=1) & still.any(axis=1)
        pixel = pixel[known]
        tilts.append(
            Slopes(
                slope=slopes(normal[known], still[known], optics.camera),
                place=places(pixel, optics.camera.width_px, optics.camera.height_px),
                pixel=pixel,
            )
        )
    monitor(1.0, "predictions drawn")
    return Predictions(rest=rest, images=tuple(images), slopes=tuple(tilts))


def depths_of(
    presses: Sequence[BallPress], fitted: Sequence[int], fitted_mm: np.ndarray
) -> list[float]:
    """Depth of every press [mm]: fitted, given, or from the circle as the fitted ones say.

    A held-out photograph tells its circle alone. How the depths that were fitted go with Hertz's of
    their circles is a line, whose slope, by regression, is the less the more the circles scatter.
    """
    guesses = np.array([presses[k].guess_mm for k in fitted])
    spread = guesses - guesses.mean()
    together = float(spread @ (fitted_mm - fitted_mm.mean()))
    slope = np.clip(together / max(float(spread @ spread), 1e-12), 0.0, 1.5)
    mean = float(fitted_mm.mean())
    found = [
        float(np.clip(mean + slope * (each.guess_mm - guesses.mean()), each.least_mm, each.most_mm))
        for each in presses
    ]
    for number, depth in zip(fitted, fitted_mm, strict=True):
        found[number] = float(depth)
    return found


def left_of(
    first: Predictions, seen: Sequence[SeenPhoto], fitted: Sequence[int]
) -> tuple[np.ndarray, np.ndarray]:
    """Centres and weights of the residual that the light leaves in the fitted photographs."""
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
