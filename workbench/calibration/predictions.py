"""What the calibrated design shows of each press: through the same studio as every image."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sim.optics.studio.unit_residual import places, slopes
from workbench.calibration.lit_studio import lit_studio
from workbench.calibration.residual import Slopes
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
    return Predictions(rest=rest, images=tuple(images), slopes=tuple(tilts))
