"""The test on a twin: photographs of a sensor with hidden parameters, and its calibration.

A task takes the twin's presses, or its slides where markers are seen. Light and camera are then
fitted to the twin's photographs of a ball, as a builder would, without a look at what is hidden.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

from workbench.core.base.monitor import Monitor
from workbench.core.design.design import SensorDesign
from workbench.core.design.optics import Optics
from workbench.learning.dataset.recipe import Recipe
from workbench.pipeline.store import Store
from workbench.project.design_toml import design_table
from workbench.tasks.kept.kept_calibration import kept_calibration
from workbench.tasks.task import Look, Size, Task
from workbench.twin.cases import Kind
from workbench.twin.first_camera import seen_at
from workbench.twin.make import make_twin
from workbench.twin.twin_folder import FOLDERS
from workbench.twin.twin_plan import TwinPlan

if TYPE_CHECKING:
    from workbench.calibration.seen.photo_set import PhotoSet

CALIBRATION = {Size.SMALL: 8, Size.PAPER: 20}
PRESSES = {Size.SMALL: 24, Size.PAPER: 140}
SLIDES = {Size.SMALL: 8, Size.PAPER: 100}
CALIBRATED = "calibrated"
"""Folder of what was fitted, beside the twin's."""
WIDTH_PX = 320
"""Of the twin's photographs [px]."""
LIGHTS = "known"
"""A builder knows how many lights there are, and where they were meant to be."""
REFINED = {Size.SMALL: "powers", Size.PAPER: "all"}
"""What is fitted: powers and colours of the lights alone, or camera and coating as well, which
takes minutes: by it a dent is found nearer to its place (presses of .3 mm in a finger's twin are
read .059 mm off, with powers .095), but eight photographs so fitted told .68 of the objects, and
by powers alone .72."""


def twin_plan(task: Task, size: Size, recipe: Recipe, jobs: int) -> TwinPlan:
    """How much of a twin a task needs; objects are as large as the middle of the recipe's."""
    low_mm, high_mm = recipe.vary.size_mm or (recipe.size_mm, recipe.size_mm)
    slides = task.look is not Look.PLAIN
    return TwinPlan(
        calibration=CALIBRATION[size],
        presses=0 if slides else PRESSES[size],
        slides=SLIDES[size] if slides else 0,
        width_px=min(WIDTH_PX, recipe.design.optics.camera.width_px),
        object_mm=0.5 * (low_mm + high_mm),
        jobs=jobs,
    )


def photographed(
    design: SensorDesign, out: Path, plan: TwinPlan, store: Store, monitor: Monitor
) -> tuple[Path, dict[str, Any]]:
    """Photograph a twin; the folder of the photographs to tell, and what is hidden.

    Raises:
        WorkbenchError: As `make_twin`.
    """
    made = make_twin(design, out, plan, store, monitor)
    kind = Kind.SLIDE if plan.slides else Kind.PRESS
    card = json.loads((made.folder / "card.json").read_bytes())
    told = {
        "photos": {kind.value: count for kind, count in made.photos.items()},
        "failed": len(made.failed),
        "contact": plan.contact.value,
        "seed": plan.seed,
        "hidden": card["hidden"],
    }
    return made.folder / FOLDERS[kind], told


def calibrated(
    design: SensorDesign, twin: Path, size: Size, store: Store, monitor: Monitor
) -> tuple[Optics, dict[str, Any]]:
    """Light and camera fitted to a twin's photographs of a ball, and how well they explain them.

    Kept in a folder beside the twin's.

    Args:
        design: The nominal one.
        twin: Folder of the twin.
        size: Says what is fitted.
        store: Keeps presses and light.
        monitor: Progress and cancellation.

    Raises:
        WorkbenchError: As `calibrate`.
    """
    from workbench.calibration.seen.photo_set import read_photo_set

    photos = read_photo_set(twin / FOLDERS[Kind.CALIBRATION])
    height_px, width_px = photos.idle.shape[:2]
    sized = seen_at(design, width_px, height_px)

    def fit() -> tuple[SensorDesign, dict[str, Any]]:
        return _fitted(sized, photos, REFINED[size], store, monitor)

    rests_on = [design_table(sized), LIGHTS, REFINED[size], photos.idle, *photos.photos]
    whole, told = kept_calibration(twin.with_name(CALIBRATED), rests_on, fit)
    return whole.optics, told


def _fitted(
    design: SensorDesign, photos: PhotoSet, refining: str, store: Store, monitor: Monitor
) -> tuple[SensorDesign, dict[str, Any]]:
    from workbench.calibration.calibrate import calibrate
    from workbench.calibration.fitted_design import with_unit
    from workbench.core.design.unit import unit

    found = calibrate(design, photos, store, lights=LIGHTS, monitor=monitor, refining=refining)
    return with_unit(found.design, unit("unit.npz", found.unit_data)), {
        "fitted": refining,
        "photos": len(photos.photos),
        "error_grey": found.powers.error_grey,
        "null_grey": found.powers.null_grey,
    }
