"""A task for a design from end to end: presses, trainings, tests.

    data         presses of the task's recipe, seen by several built sensors, in `data`
    sim          three seeds, renders split at random, as in the paper
    sim_by_place three seeds, by place
    photos       the user's own, told by the networks of `sim`
    twin         photographs of a sensor with hidden parameters, told by the networks of `sim`
    calibrated   light and camera fitted to the twin's ball, the presses seen anew, trained anew;
                 where dents or windows are seen, only the photographs, by that light and camera

Stopped, it goes on where it was: presses, what was seen of them, trainings and photographs that are
there are kept.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from workbench.core.base.digest import digest
from workbench.core.base.errors import DesignError
from workbench.core.base.monitor import Monitor, part
from workbench.core.design.design import SensorDesign
from workbench.core.design.optics import Optics
from workbench.learning.dataset.folder import DataSet
from workbench.learning.dataset.lock import held
from workbench.learning.dataset.recipe import Recipe
from workbench.learning.making.collect import make, prepare
from workbench.learning.making.watch import SetProgress
from workbench.pipeline.devices import torch_device
from workbench.project.design_toml import design_table
from workbench.project.project import Project
from workbench.tasks.examples import Examples, examples
from workbench.tasks.features import IN_ANY_LIGHT, seen_once, with_features
from workbench.tasks.kept.step_times import StepTimes
from workbench.tasks.kept_examples import kept_examples
from workbench.tasks.lessons import Lessons
from workbench.tasks.outcome import Tested, Trial
from workbench.tasks.photo_folder import PhotoFolder
from workbench.tasks.photo_training import on_photos
from workbench.tasks.rendered import Looker, Renders, rendered
from workbench.tasks.reshoot import Reshot, sees_outer_skin
from workbench.tasks.safety_scale import SafetyScale
from workbench.tasks.seen_images import View, view_of, whole
from workbench.tasks.slip_delay import tell_slides
from workbench.tasks.task import Look, Net, Size, Task, task_of
from workbench.tasks.trained import Trained, Trainer
from workbench.tasks.twin_test import calibrated, photographed, twin_plan

SPANS = {
    "data": (0.0, 0.45),
    "images": (0.45, 0.53),
    "features": (0.53, 0.55),
    Trial.SIM: (0.55, 0.61),
    Trial.PLACE: (0.61, 0.67),
    Trial.PHOTOS: (0.67, 0.68),
    Trial.TWIN: (0.68, 0.85),
    "calibrate": (0.85, 0.9),
    Trial.CALIBRATED: (0.9, 1.0),
}
"""Part of each step in the whole."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Plan:
    """What is asked for."""

    task: str
    size: Size = Size.SMALL
    net: Net = Net.LITE
    photos: Path | None = None
    data: Path | None = None
    """Folder of presses of the same recipe, made before or to be made; none: in the results'."""
    jobs: int = 1
    twin: bool = True
    """Whether a twin is photographed too."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Result:
    """What came out."""

    plan: Plan
    design: SensorDesign
    tests: list[Tested]
    details: dict[str, Any]


def run_task(
    design: SensorDesign, plan: Plan, out: Path, project: Project, monitor: Monitor
) -> Result:
    """Run a task, or the rest of it.

    Args:
        design: Whose sensor is to tell.
        plan: Which task, how much, by which network.
        out: All that is made comes here.
        project: Its store keeps mesh and light.
        monitor: Progress and cancellation.

    Raises:
        DesignError: If the photographs do not suit the task, or the design not the recipe.
        StoreError: If the folder is another's, or cannot be written.
        WorkbenchError: As stages, calibration and twin.
    """
    task = task_of(plan.task)
    folder = None if plan.photos is None else PhotoFolder.open(plan.photos)
    if folder is not None:
        # Photographs that do not suit are told before anything is pressed.
        list(folder.seen(task, whole(plan.net), design.optics.camera))
    with held(out, doing="running the task in"):
        work = _Work(
            task=task,
            plan=plan,
            design=design,
            recipe=task.recipe(design, plan.size),
            out=out,
            project=project,
            monitor=monitor,
            times=_times(task, plan, design, out),
        )
        return work.run(folder)


def _times(task: Task, plan: Plan, design: SensorDesign, out: Path) -> StepTimes:
    key = digest([plan.task, plan.net.value, task.recipe(design, plan.size).key])
    return StepTimes(out / "times.json", key)


@dataclass(frozen=True, kw_only=True, slots=True)
class _Work:
    """One task under way."""

    task: Task
    plan: Plan
    design: SensorDesign
    recipe: Recipe
    out: Path
    project: Project
    monitor: Monitor
    times: StepTimes

    def run(self, folder: PhotoFolder | None) -> Result:
        with self.times.of("data"):
            data = self._data()
        own = Renders(data, marked=self._marked)
        with self.times.of("images"):
            view = self._view(self.design.optics)
            looker = Looker(view=view, data=data, images=own)
            lessons = self._lessons(Trial.SIM, looker, self.design.optics)
        tests, networks = [], dict[Trial, list[Trained]]()
        for test in (Trial.SIM, Trial.PLACE):
            with self.times.of(test):
                runs = lessons.learned(test, self._span(test))
            networks[test] = [run.trained for run in runs]
            tests.append(lessons.on_renders(test, runs))
        if view.sight is not None and self.task.look is Look.WINDOW:
            tell_slides(lessons, networks, tests, self.recipe.shear_step_mm)
        details = {
            **lessons.told_of(networks[Trial.SIM][0]),
            "design": digest(design_table(self.design)),
            "recipe": self.recipe.key,
        }
        if folder is not None:
            with self.times.of(Trial.PHOTOS):
                photos = self._photos(folder, lessons, view)
                tests.append(lessons.on_photos(Trial.PHOTOS, photos, networks[Trial.SIM]))
                own_training = on_photos(lessons, photos, self._span(Trial.PHOTOS))
                details["trained_on_photos"] = own_training
        if self.plan.twin:
            tests += self._twin(data, (lessons, view), networks[Trial.SIM], details)
        details["seconds"] = self.times.seconds
        return Result(plan=self.plan, design=self.design, tests=tests, details=details)

    @property
    def _marked(self) -> bool:
        return self.task.look is not Look.PLAIN

    def _span(self, name: str) -> Monitor:
        return part(self.monitor, *SPANS[name])

    def _data(self) -> DataSet:
        monitor = self._span("data")

        def tell(progress: SetProgress) -> None:
            done = progress.done / max(progress.total, 1)
            monitor(done, f"{progress.done} of {progress.total} samples")

        return make(
            self.recipe,
            self.plan.data or self.out / "data",
            self.project,
            jobs=self.plan.jobs,
            tell=tell,
            monitor=lambda stage, fraction, note: monitor(0.0, f"{stage} {note}"),
        )

    def _view(self, optics: Optics) -> View:
        """What is shown of the design by its own or by other optics."""
        calls = prepare(self.recipe, self.project, [], None)
        store = self.project.store
        mesh = store.load("mesh", calls["mesh"].key)
        design = dataclasses.replace(self.design, optics=optics)
        return view_of(self.plan.net, mesh, design, store)

    def _photos(self, folder: PhotoFolder, lessons: Lessons, view: View) -> Examples:
        """Photographs as examples with the outputs of the renders."""
        task, scale = lessons.task, lessons.trainer.safety
        seen = folder.seen(task, view, self.design.optics.camera)
        outputs = lessons.found.outputs if scale is None else task.columns
        found = seen_once(examples(task, seen, outputs), self.plan.net)
        return found if scale is None else scale.with_safety(found)

    def _lessons(self, test: Trial, looker: Looker, optics: Optics) -> Lessons:
        """All examples of the renders in some light, for a test, and who learns from them."""
        span, jobs = self._span("images"), self.plan.jobs
        found = kept_examples(
            self.out / f"seen_{test}.npz",
            self._rests_on(looker.data, optics),
            lambda: examples(self.task, rendered(self.task, looker, span, jobs)),
        )
        scale = None
        if self.task.safety:
            scale = SafetyScale.of(found)
            found = scale.with_safety(found)
        trainer = Trainer(
            task=self.task,
            net=self.plan.net,
            folder=self.out / "networks",
            safety=scale,
            device=torch_device(),
        )
        found = with_features(
            found, self.task, self.plan.net, trainer.device, self._span("features")
        )
        return Lessons(name=self.plan.task, task=self.task, trainer=trainer, found=found)

    def _twin(
        self,
        data: DataSet,
        nominal: tuple[Lessons, View],
        networks: list[Trained],
        details: dict[str, Any],
    ) -> list[Tested]:
        """The tests on a twin, before and after it is calibrated."""
        size, store, folder = self.plan.size, self.project.store, self.out / "twin"
        plan = twin_plan(self.task, size, self.recipe, self.plan.jobs)
        with self.times.of(Trial.TWIN):
            place, details["twin"] = photographed(
                self.design, folder, plan, store, self._span(Trial.TWIN)
            )
            photos, lessons = PhotoFolder.open(place), nominal[0]
            seen = self._photos(photos, *nominal)
            tests = [lessons.on_photos(Trial.TWIN, seen, networks)]
        with self.times.of(Trial.CALIBRATED):
            try:
                optics, details["calibration"] = calibrated(
                    self.design, folder, size, store, self._span("calibrate")
                )
            except DesignError as error:
                # Photographs that cannot be calibrated to are a result too.
                details["calibration"] = {"why_not": error.message}
                return tests
            view = self._view(optics)
            again = lessons
            if self.plan.net not in IN_ANY_LIGHT:
                again = self._seen_anew(data, optics, view)
                runs = again.learned(Trial.CALIBRATED, self._span(Trial.CALIBRATED))
                networks = [run.trained for run in runs]
            # What is the same in any light is learned once: photographs alone are read by theirs.
            seen = self._photos(photos, again, view)
            tests.append(again.on_photos(Trial.CALIBRATED, seen, networks))
        return tests

    def _seen_anew(self, data: DataSet, optics: Optics, view: View) -> Lessons:
        """The same presses in calibrated light; where pins are seen, pressed anew."""
        if sees_outer_skin(self.recipe, self.project):
            anew = Reshot(self.recipe, optics, self.project, None, marked=self._marked)
            looker = Looker(view=view, data=data, images=anew)
            return self._lessons(Trial.CALIBRATED, looker, optics)
        design = dataclasses.replace(self.design, optics=optics)
        recipe = dataclasses.replace(self.recipe, design=design)
        other = make(recipe, self.out / "data_calibrated", self.project, jobs=self.plan.jobs)
        own = Renders(other, marked=self._marked)
        looker = Looker(view=view, data=other, images=own)
        return self._lessons(Trial.CALIBRATED, looker, optics)

    def _rests_on(self, data: DataSet, optics: Optics) -> list[object]:
        """What examples of a data set in some light are of."""
        seen_by = design_table(dataclasses.replace(self.design, optics=optics))
        frames = [[case.id, data.frames(case)] for case in data.cases()]
        return [self.plan.task, self.plan.net.value, data.key, frames, seen_by]
