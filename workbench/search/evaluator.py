"""A design judged for a search, the cheapest check first, so that most refusals cost no press.

The order: the fields together, the plan, the body, LEDs, cameras and target in it, the parts of
the mould, light and maps, the press and its images. After each step the limits whose figures are
known are looked at; where one is broken, what is left is spared. Results go through the project's
store, so that whatever a trial shares with an earlier one costs nothing.
"""

from __future__ import annotations

import dataclasses
import time
from collections import Counter
from collections.abc import Iterator, Mapping
from typing import Any

from workbench.core.base.errors import Cancelled, DesignError, WorkbenchError
from workbench.core.base.monitor import Monitor, silent
from workbench.pipeline.stage import Call
from workbench.planning.foresight import expect_fit
from workbench.planning.plan import InlineRunner, Runner, evaluate, needed, plan
from workbench.project.project import Project
from workbench.project.state import State
from workbench.search.applying import followed, state_of
from workbench.search.even_light import POWERS, evened, light_of_leds
from workbench.search.judged import Judged, Status
from workbench.search.problem import Problem, Value
from workbench.search.search_figures import SAME, Found, all_figures, stages_of

STEPS = (("build",), ("mould", "housing", "recipe"), ("bake",), ("maps",), ("shoot",))
"""Stages in the order of what they cost."""
KEPT = ("build", "mesh", "press", "shoot", "maps", "bake", "mould", "housing", "recipe")
"""Stages whose keys a trial keeps."""


@dataclasses.dataclass(slots=True)
class _Trial:
    """One that is being judged."""

    state: State
    calls: dict[str, Call]
    wanted: tuple[str, ...]
    figures: dict[str, float] = dataclasses.field(default_factory=dict)
    ran: Counter[str] = dataclasses.field(default_factory=Counter)
    found: Counter[str] = dataclasses.field(default_factory=Counter)

    @property
    def keys(self) -> dict[str, str]:
        done = self.ran | self.found
        return {name: self.calls[name].key for name in KEPT if name in done}

    @property
    def skipped(self) -> dict[str, int]:
        """What was asked for and neither ran nor was found."""
        done = self.ran | self.found
        return {name: 1 for name in needed(self.calls, self.wanted) if name not in done}


class DesignEvaluator:
    """Judges designs of a problem; stages run in this process, or where a runner lets them."""

    def __init__(
        self,
        problem: Problem,
        project: Project,
        *,
        draft: bool = True,
        runner: Runner | None = None,
    ) -> None:
        self.problem = problem
        self.runner = runner or InlineRunner(project.store)
        self.project = project
        self.draft = draft
        names = tuple(each.figure for each in (*problem.goals, *problem.limits))
        self.wanted = stages_of(names)
        self._base_shot: Any = None
        self._likeness = SAME in names

    @property
    def of_the_press(self) -> frozenset[str]:
        """Varied fields by which the key of the press changes, tried one by one on the base.

        None where no press is needed, or a light field alone could not vary beside it.
        """
        if "shoot" not in self.wanted:
            return frozenset()
        return frozenset(
            vary.path for vary in self.problem.vary if len(self._press_keys(vary.path)) > 1
        )

    def _press_keys(self, path: str) -> set[str]:
        (vary,) = (each for each in self.problem.vary if each.path == path)
        middle = 0.5 * (vary.low + vary.high)
        values: tuple[Value, ...] = vary.choices or (vary.low, middle, vary.high)
        keys = set()
        for value in values:
            try:
                state = self._state({path: value})
                keys.add(plan(state.design, state.case)["press"].key)
            except DesignError:
                # A value that is refused presses nothing.
                continue
        return keys

    def _state(self, values: Mapping[str, Value]) -> State:
        return state_of(self.problem, values, draft=self.draft)

    def judge_base(self, monitor: Monitor) -> Judged:
        """What comes of the base: nothing of it is spared, whatever limits say."""
        judged = self.judge_state(lambda: self._state({}), monitor, sparing=False)
        key = judged.keys.get("shoot", "none")
        if self._likeness and self.project.store.has("shoot", key):
            self._base_shot = self.project.store.load("shoot", key)
            own = {SAME: 100.0}
            return dataclasses.replace(judged, figures={**judged.figures, **own})
        return judged

    def judge(self, values: Mapping[str, Value], monitor: Monitor) -> Judged:
        """What comes of these values."""
        parameters = {**values, **followed(self.problem, values)}
        judged = self.judge_state(lambda: self._state(values), monitor)
        return dataclasses.replace(judged, parameters={**parameters, **judged.parameters})

    def judge_state(self, make: Any, monitor: Monitor = silent, *, sparing: bool = True) -> Judged:
        """What comes of a state.

        Args:
            make: Makes it; may refuse.
            monitor: Progress and cancellation.
            sparing: Whether a broken limit ends the trial.
        """
        began = time.monotonic()
        trial: _Trial | None = None
        solved: dict[str, Value] = {}
        status, reason = Status.JUDGED, ""
        try:
            state: State = make()
            trial = self._begun(state)
            for step, names in enumerate(STEPS):
                monitor(step / len(STEPS), " and ".join(names))
                if names == ("bake",) and self.problem.even_light:
                    trial, solved = self._with_even_light(trial)
                self._run(trial, names, monitor)
                reason = self._broken(trial.figures) if sparing else ""
                if reason and trial.skipped:
                    status = Status.REFUSED
                    break
            else:
                reason = ""
                self._expect_all(trial)
        except Cancelled:
            raise
        except WorkbenchError as error:
            refused = isinstance(error, DesignError)
            status = Status.REFUSED if refused else Status.FAILED
            reason = error.message
        spent = time.monotonic() - began
        if trial is None:
            return Judged(status=status, reason=reason, seconds=spent)
        return Judged(
            status=status,
            figures=trial.figures,
            reason=reason,
            seconds=spent,
            ran=dict(trial.ran),
            found=dict(trial.found),
            skipped=trial.skipped,
            keys=trial.keys,
            parameters=solved,
        )

    def _begun(self, state: State) -> _Trial:
        calls = plan(state.design, state.case)
        return _Trial(state=state, calls=calls, wanted=self.wanted)

    def _run(self, trial: _Trial, names: tuple[str, ...], monitor: Monitor) -> None:
        """Compute the stages of a step that are wanted, and read the figures."""
        wanted = [name for name in names if name in trial.wanted or name == "build"]
        if not wanted:
            return
        design, case = trial.state.design, trial.state.case

        def told(stage: str, fraction: float, note: str) -> None:
            monitor(0.5, f"{stage} {100.0 * fraction:.0f} %")

        for outcome in evaluate(design, case, self.runner, wanted=wanted, monitor=told):
            if not (trial.ran[outcome.stage] or trial.found[outcome.stage]):
                (trial.found if outcome.cached else trial.ran)[outcome.stage] += 1
        trial.ran, trial.found = +trial.ran, +trial.found
        if "build" in wanted:
            solid = self.project.store.load("build", trial.calls["build"].key)
            expect_fit(solid, design.optics, case if "shoot" in trial.wanted else _untouched(case))
        trial.figures |= all_figures(
            Found(
                store=self.project.store,
                state=trial.state,
                keys=trial.keys,
                prices=self.problem.prices,
                base_shot=self._base_shot,
            )
        )

    def _with_even_light(self, trial: _Trial) -> tuple[_Trial, dict[str, Value]]:
        """The trial with LED powers for even light."""
        from geometry.surface.surface import vertex_areas_mm2

        design, case = trial.state.design, trial.state.case
        for outcome in evaluate(design, case, self.runner, wanted=("mesh",)):
            if outcome.stage == "mesh":
                (trial.found if outcome.cached else trial.ran)["mesh"] += 1
        mesh = self.project.store.load("mesh", trial.calls["mesh"].key)
        optics = design.optics
        light = light_of_leds(mesh, optics.ring, optics.lamps)
        areas = vertex_areas_mm2(mesh.seen.points_mm, mesh.seen.faces)
        ring = evened(optics.ring, light, areas)
        state = dataclasses.replace(trial.state, design=design.replace("optics.ring", ring))
        again = self._begun(state)
        again.figures, again.ran, again.found = trial.figures, trial.ran, trial.found
        return again, {POWERS: ",".join(f"{power:g}" for power in ring.powers)}

    def _broken(self, figures: Mapping[str, float]) -> str:
        """The first limit that is known to be broken, in words."""
        return next(_broken_words(self.problem, figures), "")

    def _expect_all(self, trial: _Trial) -> None:
        for each in (*self.problem.goals, *self.problem.limits):
            if each.figure not in trial.figures and each.figure != SAME:
                raise WorkbenchError(f"{each.figure} does not exist for this design")


def _broken_words(problem: Problem, figures: Mapping[str, float]) -> Iterator[str]:
    for limit in problem.limits:
        found = figures.get(limit.figure)
        if found is not None and limit.excess(found) > 0.0:
            yield f"{limit.figure} is {found:.5g}, the limit {limit.words}"


def _untouched(case: Any) -> Any:
    """A press that is not computed need not reach the skin."""
    path = dataclasses.replace(case.press, depth_mm=1e-3)
    return dataclasses.replace(case, press=path)
