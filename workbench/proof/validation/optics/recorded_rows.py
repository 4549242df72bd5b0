"""The product's images beside figures that Mitsuba 3 recorded of the same sensors.

Two numbers of each scene: all light of the image over Mitsuba's, and how far squares of 8 x 8
pixels are off in each colour, root mean square over their mean. The ceiling of the latter is what
chance alone leaves: standard errors of Mitsuba's figures and of our photons together. Nothing is
fitted. The null is an even image of the right mean.

The record is of skin seen through the wall; what a path tracer shows besides, mirror images of skin
and LEDs in the wall, is stated: the product leaves them out.
"""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from workbench.core.base.errors import WorkbenchError
from workbench.core.design.optics import BEST
from workbench.proof.row import Row, bounded, compared, failed, stated
from workbench.proof.validation.optics.mitsuba_record import Recorded, recorded
from workbench.proof.validation.optics.recorded_images import best_image, photon_halves
from workbench.proof.validation.optics.recorded_scenes import SCENES, RecordedScene, cells

TOTAL_LIMIT = {"photons": 0.01, str(BEST): 0.03}
PLACES_LIMIT = {"photons": 0.03, str(BEST): 0.05}


@dataclass(frozen=True, kw_only=True, slots=True)
class Likeness:
    """One image beside Mitsuba's figures, relative [1]."""

    total: float
    """All light over Mitsuba's."""
    places: float
    """Root mean square of the squares' differences over their mean."""
    chance: float
    """What `places` would be of a right image, from the standard errors of both."""


def rows() -> list[Row]:
    """All rows of all scenes."""
    return [row for number in range(len(SCENES)) for row in _scene_rows(number)]


def _scene_rows(number: int) -> list[Row]:
    scene = SCENES[number]
    try:
        record = recorded(number)
    except WorkbenchError as error:
        return [failed("mitsuba_recorded", scene.name, unit="1", why=error.message)]
    return [
        *_model_rows(scene, "photons", functools.cache(lambda: traced_likeness(scene, record))),
        *_model_rows(scene, str(BEST), functools.cache(lambda: best_likeness(scene, record))),
        *_record_rows(scene, record),
    ]


def _model_rows(scene: RecordedScene, model: str, found: Callable[[], Likeness]) -> Iterator[Row]:
    record = recorded(SCENES.index(scene))
    yield compared(
        "mitsuba_recorded",
        f"{scene.name}: {model}, all light of the image over Mitsuba's",
        lambda: found().total,
        1.0,
        unit="1",
        limit=TOTAL_LIMIT[model],
        ceiling=_total_error(record),
    )
    even = likeness(np.broadcast_to(record.mean.mean(axis=(0, 1)), record.mean.shape), record)
    try:
        chance = found().chance
    except WorkbenchError as error:
        yield failed("mitsuba_recorded_places", scene.name, unit="1", why=error.message)
        return
    yield bounded(
        "mitsuba_recorded_places",
        f"{scene.name}: {model}, squares of 8 x 8 pixels, rms over their mean; null: even; "
        "ceiling: chance",
        lambda: found().places,
        unit="1",
        limit=PLACES_LIMIT[model],
        null=even.places,
        ceiling=chance,
    )


def _record_rows(scene: RecordedScene, record: Recorded) -> Iterator[Row]:
    source = f"Mitsuba {record.version}, {record.samples} samples of each pixel"
    yield stated(
        "mitsuba_recorded_error",
        f"{scene.name}: standard error of a square, rms over the mean; {source}",
        likeness(record.mean, record).chance,
        unit="1",
    )
    yield stated(
        "mitsuba_recorded_whole",
        f"{scene.name}: all that a path tracer shows, mirror images in the wall too, over what is "
        "seen through it; the product leaves the rest out",
        float(record.whole.sum() / record.mean.sum()),
        unit="1",
    )


def traced_likeness(scene: RecordedScene, record: Recorded) -> Likeness:
    """Of photons.

    Raises:
        WorkbenchError: From tracing.
    """
    halves = cells(photon_halves(scene, scene.optics))
    return likeness(halves.mean(axis=0), record, error=np.abs(halves[0] - halves[1]) / 2.0)


def best_likeness(scene: RecordedScene, record: Recorded) -> Likeness:
    """Of the default light model.

    Raises:
        WorkbenchError: From the stages.
    """
    return likeness(cells(best_image(scene, scene.optics)), record)


def likeness(image: np.ndarray, record: Recorded, *, error: np.ndarray | None = None) -> Likeness:
    """Squares of an image (6, 8, 3), with their standard errors, beside the record."""
    variance = record.error**2 + (0.0 if error is None else error**2)
    mean = record.mean.mean()
    return Likeness(
        total=float(image.sum() / record.mean.sum()),
        places=float(np.sqrt(np.mean((image - record.mean) ** 2)) / mean),
        chance=float(np.sqrt(np.mean(variance)) / mean),
    )


def _total_error(record: Recorded) -> float:
    """Relative standard error [1] of all light of the record."""
    return float(np.sqrt((record.error**2).sum()) / record.mean.sum())
