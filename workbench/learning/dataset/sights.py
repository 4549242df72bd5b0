"""What sees the samples of a data set: the design's camera and light, or those of built sensors.

Each is a chain of stages of its own, so that its light is baked once and found again in the store.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from workbench.core.design.optics import Optics
from workbench.core.press.press import ContactSettings
from workbench.core.press.press_case import PressCase
from workbench.core.result.results import MembraneMesh
from workbench.learning.dataset.folder import MARKED, MARKERS_PX, PLAIN, background_name
from workbench.learning.dataset.looks import built
from workbench.learning.dataset.recipe import Recipe
from workbench.pipeline.seen_optics import seen_optics
from workbench.pipeline.stage import Call
from workbench.pipeline.store import Store
from workbench.planning.plan import plan
from workbench.system.whole_files import write_atomically

if TYPE_CHECKING:
    from workbench.learning.dataset.images import Cameras

LIGHT = ("bake", "table")
"""Stages of light; a design may have no `table`."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Sight:
    """One sensor that sees; small, as it is sent to each worker."""

    optics: Optics
    calls: dict[str, Call]
    """Of its light, by stage, with all that they read."""

    def cameras(self, mesh: MembraneMesh, store: Store) -> Cameras:
        """Its camera, opened; its light must be in the store.

        Raises:
            DesignError: If the camera is outside the cavity or sees nothing of the skin.
            OpticsError: If no light reaches what the camera sees.
        """
        from workbench.learning.dataset.images import Cameras

        light, *tables = (store.load(n, self.calls[n].key) for n in LIGHT if n in self.calls)
        return Cameras(mesh, light, seen_optics(self.optics), tables[0] if tables else None)


def sights_of(recipe: Recipe) -> list[Sight]:
    """What sees the samples of a recipe, by the numbers that cases draw; none without images."""
    if not recipe.images:
        return []
    own = _in_size(recipe.design.optics, recipe.image_width_px)
    looks = recipe.vary.looks
    seen = [built(own, looks, seed=recipe.seed, number=k) for k in range(looks.count)] or [own]
    case = PressCase(settings=ContactSettings(grid_mm=recipe.grid_mm))
    return [
        Sight(
            optics=optics,
            calls=plan(dataclasses.replace(recipe.meshed_design, optics=optics), case),
        )
        for optics in seen
    ]


def _in_size(optics: Optics, width_px: int) -> Optics:
    """Optics whose first camera has images of this width, in proportion; 0: as it is."""
    camera = optics.camera
    if not width_px:
        return optics
    height_px = max(1, round(camera.height_px * width_px / camera.width_px))
    smaller = dataclasses.replace(camera, width_px=width_px, height_px=height_px)
    return dataclasses.replace(optics, camera=smaller)


def write_backgrounds(folder: Path, recipe: Recipe, sights: list[Sight], store: Store) -> None:
    """Images and markers of the skin at rest, once for each sight."""
    names = [number if recipe.vary.looks.count else None for number in range(len(sights))]
    todo = [
        (sight, look)
        for sight, look in zip(sights, names, strict=True)
        if not (folder / background_name(MARKERS_PX, look, ".npy")).exists()
    ]
    if not todo:
        return
    from workbench.pipeline.devices import open_device

    open_device()
    for sight, look in todo:
        mesh = store.load("mesh", sight.calls["mesh"].key)
        rest = sight.cameras(mesh, store).at_rest()
        write_atomically(folder / background_name(PLAIN, look, ".png"), rest.png)
        write_atomically(folder / background_name(MARKED, look, ".png"), rest.png_markers)
        write_atomically(folder / background_name(MARKERS_PX, look, ".npy"), rest.markers_npy)
