"""The built sensors that views are seen by: those of a recipe, each with light of its own."""

from __future__ import annotations

import dataclasses
from typing import TYPE_CHECKING

from sim.reading.network.spec import COLUMNS
from workbench.core.design.design import SensorDesign
from workbench.core.result.results import MembraneMesh
from workbench.learning.dataset.recipe import Recipe
from workbench.learning.dataset.sights import LIGHT, Sight, sights_of
from workbench.learning.dataset.variation import Looks
from workbench.learning.readers.beginning import is_calibrated
from workbench.pipeline.seen_optics import seen_optics
from workbench.pipeline.store import Store
from workbench.reading.design_reader import looked_up

if TYPE_CHECKING:
    from sim.reading.shown_press import PressCamera

LEFT = Looks(power_share=0.05, ring_mm=0.1, camera_mm=0.3, camera_deg=0.5, focal_share=0.01)
"""What a calibrated design may still be off by: our choice, by twins whose calibration left .06 to
.39 mm of the camera's place."""
JUDGING = 2
"""Built sensors that nothing is learned from: the last but one for validation, the last to test."""


def plain_design(design: SensorDesign) -> SensorDesign:
    """A design whose images hold no noise of their own, in light that can be looked up.

    Noise is drawn anew each time a view is learned from.
    """
    design = looked_up(design)
    camera = design.optics.camera
    quiet = dataclasses.replace(camera, sensor=dataclasses.replace(camera.sensor, noise=False))
    return dataclasses.replace(design, optics=dataclasses.replace(design.optics, camera=quiet))


def built_sights(recipe: Recipe, count: int) -> list[Sight]:
    """What sees the views of a recipe's presses: so many sensors, and those that judge.

    A calibrated design is off by less than one that hands are still to build.
    """
    off = LEFT if is_calibrated(recipe.design) else Looks()
    looks = dataclasses.replace(off, count=count + JUDGING)
    vary = dataclasses.replace(recipe.vary, looks=looks)
    return sights_of(dataclasses.replace(recipe, images=True, image_width_px=COLUMNS, vary=vary))


def open_camera(sight: Sight, mesh: MembraneMesh, store: Store) -> PressCamera:
    """The camera of a built sensor, whose light must be in the store; the device must be open.

    Raises:
        DesignError: If the camera is outside the cavity or sees nothing of the skin.
        OpticsError: If no light reaches what the camera sees.
    """
    from sim.optics.studio.render import Studio
    from sim.reading.shown_press import PressCamera

    light, *tables = (store.load(n, sight.calls[n].key) for n in LIGHT if n in sight.calls)
    studio = Studio(mesh, light, seen_optics(sight.optics), table=tables[0] if tables else None)
    return PressCamera(studio)
