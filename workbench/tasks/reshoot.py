"""The presses of a data set seen anew, by another light and another camera.

A press moves the skin the same whatever sees it, so only images are made: what was pressed and
judged stays. Several built sensors see them, each off by chance from the new light and camera by
less than before, since these are known from photographs now.
"""

from __future__ import annotations

import dataclasses
from typing import TYPE_CHECKING, Any

import numpy as np

from workbench.core.design.optics import Optics
from workbench.core.result.results import MembraneMesh
from workbench.learning.dataset.cases import Case
from workbench.learning.dataset.recipe import Recipe
from workbench.learning.dataset.sample import Sample
from workbench.learning.dataset.sights import Sight, sights_of
from workbench.learning.dataset.variation import Looks
from workbench.learning.making.collect import prepare
from workbench.pipeline.devices import open_device
from workbench.pipeline.store import Store
from workbench.planning.plan import StageMonitor
from workbench.project.project import Project

if TYPE_CHECKING:
    from workbench.learning.dataset.images import Cameras

LEFT_BY_CALIBRATION = 0.3
"""Of what light and camera are off by chance, what a calibration leaves: our choice."""


def known_looks(before: Looks) -> Looks:
    """Built sensors about a light and a camera that were measured."""
    return Looks(
        count=before.count,
        **{
            item.name: LEFT_BY_CALIBRATION * getattr(before, item.name)
            for item in dataclasses.fields(before)
            if item.name != "count"
        },
    )


class Reshot:
    """Cameras that see the presses of a data set in another light."""

    def __init__(
        self,
        recipe: Recipe,
        optics: Optics,
        project: Project,
        monitor: StageMonitor | None,
        *,
        marked: bool,
    ) -> None:
        """Bake the light of all built sensors.

        Args:
            recipe: Of the presses.
            optics: The other light and camera.
            project: Its store has the mesh, and gets the light.
            monitor: Progress of the light.
            marked: Whether images show markers.
        """
        looks = known_looks(recipe.vary.looks)
        seen = dataclasses.replace(
            recipe,
            design=dataclasses.replace(recipe.design, optics=optics),
            vary=dataclasses.replace(recipe.vary, looks=looks),
        )
        self._sights = sights_of(seen)
        calls = prepare(seen, project, self._sights, monitor)
        self._store: Store = project.store
        self._mesh: MembraneMesh = self._store.load("mesh", calls["mesh"].key)
        self._marked = marked
        self._opened: dict[int, Cameras] = {}
        self._rest: dict[int, np.ndarray] = {}
        self._taken: dict[int, np.ndarray] = {}
        self._of = ""

    def __getstate__(self) -> dict[str, Any]:
        """Cameras stay where they were opened: another process opens its own."""
        return {**self.__dict__, "_opened": {}, "_rest": {}, "_taken": {}, "_of": ""}

    def shown(self, case: Case, sample: Sample) -> np.ndarray:
        """The image of a sample, shape (H, W, 3), uint8."""
        if self._of != case.id:
            # Windows of a slide overlap: what was taken of it is shown again.
            self._taken, self._of = {}, case.id
        if sample.frame not in self._taken:
            solved = sample.fem or sample.mpm
            assert solved is not None, "a sample holds at least one solver's"
            self._taken[sample.frame] = self._image(case, solved.displacement_mm)
        return self._taken[sample.frame]

    def at_rest(self, case: Case) -> np.ndarray:
        """The sensor that sees a case at rest."""
        number = case.drawn.look or 0
        if number not in self._rest:
            still_mm = np.zeros_like(self._mesh.seen.points_mm, dtype=np.float32)
            self._rest[number] = self._image(case, still_mm)
        return self._rest[number]

    def _image(self, case: Case, displacement_mm: np.ndarray) -> np.ndarray:
        number = case.drawn.look or 0
        if number not in self._opened:
            open_device()
            sight: Sight = self._sights[number]
            self._opened[number] = sight.cameras(self._mesh, self._store)
        return self._opened[number].image(displacement_mm, marked=self._marked)


def sees_outer_skin(recipe: Recipe, project: Project) -> bool:
    """Whether the camera sees the skin whose displacement samples keep; pins are seen instead."""
    calls = prepare(recipe, project, [], None)
    mesh: MembraneMesh = project.store.load("mesh", calls["mesh"].key)
    return not len(mesh.tips_mm)
