"""Results of a design and a press, each computed when it is first asked for, and kept on disk."""

from __future__ import annotations

import contextlib
import dataclasses
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from sim.forces.slip import GrossSlip
from workbench.core.base.errors import DesignError, DeviceError, shown
from workbench.core.base.mapping import suggest
from workbench.core.base.packages import naming_packages
from workbench.core.design.design import SensorDesign
from workbench.core.press.indenter import Indenter
from workbench.core.press.press import ContactSettings, Press
from workbench.core.press.press_case import PressCase
from workbench.core.result.fabrication import MouldSet
from workbench.core.result.force_field import ForceField, Source
from workbench.core.result.maps import DesignerMaps
from workbench.core.result.results import MembraneMesh, Solid
from workbench.core.result.sensing import Contact, Shot
from workbench.pipeline.stage import Outcome
from workbench.planning.foresight import expect_fit
from workbench.planning.plan import InlineRunner, StageMonitor, plan
from workbench.planning.plan import evaluate as outcomes_of
from workbench.planning.stage_table import IN_RUN, STAGES
from workbench.project.aim import default_target_mm
from workbench.project.project import Project
from workbench.project.state import State
from workbench.report.source_files import STAGES as FORCE_STAGES


class Results:
    """What comes of one design and one press.

    Attributes compute what they need and nothing else, and store it in the project: asked again,
    in this process or another, they read it. All of them raise `WorkbenchError` where a stage
    fails, with what to change.
    """

    def __init__(
        self,
        design: SensorDesign,
        case: PressCase,
        project: Project,
        monitor: StageMonitor | None = None,
    ) -> None:
        self.design = design
        self.case = case
        self.project = project
        self.outcomes: list[Outcome] = []
        """Stages that were asked for: name, key, seconds, and whether they were stored."""
        self._monitor = monitor
        self._calls = plan(design, case)
        self._loaded: dict[str, Any] = {}

    @property
    def state(self) -> State:
        """Design and press as one thing."""
        return State(design=self.design, case=self.case)

    @property
    def solid(self) -> Solid:
        """The bodies of membrane, core and support."""
        return self["build"]

    @property
    def mesh(self) -> MembraneMesh:
        """The membrane's mesh: `outer.points_mm` (V, 3), `outer.faces` (M, 3), cells, regions."""
        return self["mesh"]

    @property
    def contact(self) -> Contact:
        """The press: `reaction_N` (K, 3), `displacement_mm` and `contact_force_N` (K, V, 3)."""
        return self["press"]

    @property
    def shot(self) -> Shot:
        """Tactile images of all cameras with depth, normals, masks and their figures."""
        return self["shoot"]

    @property
    def images(self) -> np.ndarray:
        """Images of the first camera, shape (K + 1, H, W, 3), uint8 sRGB; the first is at rest."""
        return self.shot.frames.rgb

    @property
    def maps(self) -> DesignerMaps:
        """Where on the skin this design sees, and how well."""
        return self["maps"]

    @property
    def moulds(self) -> MouldSet:
        """Parts of the mould, how it opens, and the checks of a printer."""
        return self["mould"]

    @property
    def figures(self) -> dict[str, float]:
        """Figures of the score card, by name, of all that is stored by now."""
        from workbench.variants.score_card import figures

        keys = {stage: call.key for stage, call in self._calls.items()}
        return figures(self.project.store, self.state, keys)

    def forces(self, source: Source | str = Source.FEM) -> Contact | ForceField:
        """Forces and displacements on the skin, `contact_force_N` (K, V, 3).

        Args:
            source: `mpm`, the contact solver; `fem`, finite elements; `learned`, the network.

        Raises:
            DesignError: If there is no such source.
        """
        (known,) = _known((source,))
        return self[FORCE_STAGES[known]]

    def gross_slip(self, source: Source | str = Source.MPM) -> GrossSlip | None:
        """When all of the contact began to slide: `way_mm` along the skin, and `frame` from 1.

        None where it did not, or where the source does not know: the network does not.

        Args:
            source: As of `forces`.

        Raises:
            DesignError: If there is no such source.
        """
        from workbench.view.forces import gross_slip

        return gross_slip(self.forces(source))

    def force_arrays(self, *sources: Source | str) -> dict[str, np.ndarray]:
        """Fields, totals and peaks of several sources side by side, on the design's outer skin.

        Of all: `points_mm` (V, 3), `faces` (M, 3), `depth_mm` (K,), `disc_mm`. Of each source,
        with its name before them, as in `fem_pressure_MPa`: `displacement_mm` and
        `contact_force_N` (K, V, 3), `pressure_MPa` (K, V), `reaction_N` and `moment_Nmm` (K, 3),
        `peak_MPa` and `peak_disc_N` (K,). What a source does not know is left out.

        Args:
            sources: As of `forces`.

        Raises:
            DesignError: If there is no such source, or none is named.
        """
        from workbench.report.source_arrays import source_arrays, source_columns
        from workbench.view.press_figures import frame_depths_mm

        if not sources:
            raise DesignError(
                "no source of forces is named",
                hint=f"give some of {', '.join(Source)}",
                at="source",
            )
        found = {source: self.forces(source) for source in _known(sources)}
        depths_mm = frame_depths_mm(self.case.press, next(iter(found.values())))
        skin = self.mesh.outer
        return source_arrays(found, source_columns(found, np.array(depths_mm), skin), skin)

    def write(self, folder: Path | str) -> dict[str, Any]:
        """Write images, arrays, tables, mould files and a report, as `workbench run` does.

        Args:
            folder: Made where there is none; files of an earlier run in it are replaced.

        Returns:
            What stands in `summary.json`.

        Raises:
            StoreError: If the folder cannot be written.
        """
        from workbench.report.outputs import FinishedRun, write_all
        from workbench.system.folder import RUN_FILES, prepare

        out = Path(folder)
        prepare(out, clear=RUN_FILES)
        self.compute(*IN_RUN)
        # The report does without the drawing where nothing can be drawn off screen.
        with contextlib.suppress(DeviceError):
            self.compute("picture")
        finished = FinishedRun(
            design=self.design, case=self.case, calls=self._calls, outcomes=self.outcomes
        )
        return write_all(out, finished, self.project.store)

    def compute(self, *stages: str) -> None:
        """Compute stages and what they need, unless they are stored.

        Raises:
            DesignError: If there is no such stage.
            WorkbenchError: From the first that fails; what was done before stays stored.
        """
        for stage in stages:
            if stage not in STAGES:
                raise DesignError(
                    f"there is no stage {shown(stage)}", hint=suggest(stage, STAGES), at="stage"
                )
        runner = InlineRunner(self.project.store)
        known = {outcome.key for outcome in self.outcomes}
        with naming_packages():
            for outcome in outcomes_of(
                self.design, self.case, runner, wanted=stages, monitor=self._monitor
            ):
                if outcome.key not in known:
                    self.outcomes.append(outcome)

    def __getitem__(self, stage: str) -> Any:
        """The result of a stage by its name; None where this design has no such stage."""
        if stage not in self._loaded:
            self.compute(stage)
            call = self._calls.get(stage)
            store = self.project.store
            self._loaded[stage] = None if call is None else store.load(stage, call.key)
        return self._loaded[stage]


def _known(sources: Sequence[Source | str]) -> tuple[Source, ...]:
    """Sources by their names."""
    known = [item.value for item in Source]
    for source in sources:
        if source not in known:
            raise DesignError(
                f"there is no source {shown(source)} of forces",
                hint=suggest(str(source), known),
                at="source",
            )
    return tuple(Source(source) for source in sources)


def evaluate(
    design: SensorDesign,
    indenter: Indenter | None = None,
    press: Press | None = None,
    *,
    settings: ContactSettings | None = None,
    project: Project | Path | str | None = None,
    monitor: StageMonitor | None = None,
) -> Results:
    """Results of pressing an object on a sensor, computed as they are asked for.

    The body is built at once, so that what does not fit it is refused within seconds.

    Args:
        design: The sensor.
        indenter: The object; a ball of 6 mm when left out.
        press: Where, how deep, in how many frames, and what follows. With its target left at the
            default, and when left out, it goes where the family is usually touched.
        settings: Of the contact solver.
        project: Folder that keeps results; `.workbench`, or `$WORKBENCH_PROJECT`, by default.
        monitor: Told stage, fraction and note while something is computed.

    Raises:
        DesignError: If the design cannot be built, or object, press or lights do not fit it.
    """
    where = project if isinstance(project, Project) else Project(project)
    path = Press() if press is None else press
    case = PressCase(
        indenter=Indenter() if indenter is None else indenter,
        press=path,
        settings=ContactSettings() if settings is None else settings,
    )
    solid = Results(design, case, where, monitor).solid
    if path.target_mm == Press().target_mm:
        path = dataclasses.replace(path, target_mm=default_target_mm(design, solid))
        case = dataclasses.replace(case, press=path)
    calls = plan(design, case)
    # What is stored was checked before it was computed, and is read without the tools for that.
    if not all(where.store.has(stage, calls[stage].key) for stage in ("press", "shoot")):
        with naming_packages():
            expect_fit(solid, design.optics, case)
    return Results(design, case, where, monitor)
