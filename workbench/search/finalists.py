"""The few designs of a front that are confirmed: by the base's own settings, and as twins.

Trials run by draft settings; what a designer builds must stand by those of the base. The twins say
how much is left where a workshop is off: the worst figure over sensors whose LEDs, wall and modulus
differ by chance, by the settings of the trials, since it is the change that counts.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from workbench.core.base.monitor import Monitor, part, silent
from workbench.learning.dataset.looks import assembled
from workbench.learning.dataset.variation import Looks
from workbench.project.project import Project
from workbench.project.state import State
from workbench.search.applying import state_of, with_settings
from workbench.search.evaluator import DesignEvaluator
from workbench.search.front import Found, Trial, keeps_limits
from workbench.search.judged import Judged, Status
from workbench.search.problem import Problem, Tolerances

PHOTONS = "design.optics.light_model=photons"
LEAST_WALL_MM = 0.2
"""Of a twin."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Worst:
    """What is left of a design over its twins."""

    figures: Mapping[str, float]
    """Of each goal and limit the worst over the twins that could be computed."""
    twins: int
    lost: int
    """Twins that do not fit together, or whose press failed."""
    kept: int
    """Twins that keep all limits."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Finalist:
    """A design of the front with all that was found of it."""

    name: str
    trial: Trial
    state: State
    """By the base's own settings."""
    confirmed: Judged | None = None
    """By those; None where nobody asked."""
    photons: Judged | None = None
    """With photons traced for each frame; figures of images only."""
    worst: Worst | None = None

    @property
    def keys(self) -> Mapping[str, str]:
        """Keys of the results that show it best."""
        return self.trial.judged.keys if self.confirmed is None else self.confirmed.keys

    @property
    def holds(self) -> bool:
        """Whether it keeps its limits by the base's own settings too."""
        return self.confirmed is None or self.confirmed.status is Status.JUDGED


def finalists(
    found: Found, project: Project, *, confirm: bool = True, monitor: Monitor = silent
) -> list[Finalist]:
    """All designs of the front, those that are confirmed spread evenly over it.

    Args:
        found: The search.
        project: Where results are kept.
        confirm: Whether anything may be computed.
        monitor: Progress and cancellation.
    """
    problem = found.problem
    chosen = _spread(len(found.front), problem.finalists) if confirm else []
    listed = []
    for number, trial in enumerate(found.front):
        state = state_of(problem, trial.judged.parameters)
        name = f"front {number + 1:02d}"
        one = Finalist(name=name, trial=trial, state=_named(state, name))
        if number in chosen:
            place = chosen.index(number)
            span = part(monitor, place / len(chosen), (place + 1) / len(chosen))
            one = _confirmed(one, problem, project, span)
        listed.append(one)
    return listed


def _spread(count: int, wanted: int) -> list[int]:
    """Numbers from one end of a front to the other."""
    if count <= wanted:
        return list(range(count))
    return sorted({round(k) for k in np.linspace(0, count - 1, max(wanted, 1))}) if wanted else []


def _named(state: State, name: str) -> State:
    return dataclasses.replace(state, design=dataclasses.replace(state.design, name=name))


def _confirmed(
    finalist: Finalist, problem: Problem, project: Project, monitor: Monitor
) -> Finalist:
    # What was solved is among the parameters.
    problem = dataclasses.replace(problem, even_light=False)
    judge = DesignEvaluator(problem, project, draft=False)
    judge.judge_base(part(monitor, 0.0, 0.1))
    judge.wanted = (*dict.fromkeys((*judge.wanted, "quality", "shoot")),)
    confirmed = judge.judge_state(lambda: finalist.state, part(monitor, 0.1, 0.4), sparing=False)
    if confirmed.status is Status.JUDGED and not keeps_limits(problem, confirmed.figures):
        reason = "by the base's own settings it breaks a limit"
        confirmed = dataclasses.replace(confirmed, status=Status.REFUSED, reason=reason)
    traced = None
    if problem.photons:
        state = with_settings(finalist.state, (PHOTONS,))
        judge = DesignEvaluator(problem, project, draft=False)
        judge.wanted = ("shoot",)
        traced = judge.judge_state(lambda: state, part(monitor, 0.4, 0.7), sparing=False)
    worst = None
    if problem.tolerances.twins:
        worst = _worst(finalist, problem, project, part(monitor, 0.7, 1.0))
    return dataclasses.replace(finalist, confirmed=confirmed, photons=traced, worst=worst)


def _worst(finalist: Finalist, problem: Problem, project: Project, monitor: Monitor) -> Worst:
    judge = DesignEvaluator(problem, project)
    judge.judge_base(silent)
    count = problem.tolerances.twins
    judged = []
    for number in range(count):
        state = with_settings(
            twin_of(finalist.state, problem.tolerances, problem.seed, number), problem.draft
        )
        span = part(monitor, number / count, (number + 1) / count)
        judged.append(judge.judge_state(lambda state=state: state, span, sparing=False))
    whole = [each.figures for each in judged if each.status is Status.JUDGED]
    return Worst(
        figures=worst_figures(problem, whole),
        twins=count,
        lost=count - len(whole),
        kept=sum(keeps_limits(problem, figures) for figures in whole),
    )


def worst_figures(problem: Problem, found: Sequence[Mapping[str, float]]) -> dict[str, float]:
    """Of each goal and limit the worst figure of several sensors."""
    worst: dict[str, float] = {}
    for limit in problem.limits:
        values = [figures[limit.figure] for figures in found if limit.figure in figures]
        if values:
            worst[limit.figure] = max(values, key=limit.excess)
    for goal in problem.goals:
        values = [figures[goal.figure] for figures in found if goal.figure in figures]
        if values:
            worst[goal.figure] = max(values, key=goal.loss)
    return worst


def twin_of(state: State, tolerances: Tolerances, seed: int, number: int) -> State:
    """A sensor as a workshop might build it, the same however many there are."""
    rng = np.random.default_rng((seed, number, 2))
    looks = Looks(
        power_share=0.0,
        ring_mm=tolerances.led_mm,
        camera_mm=0.0,
        camera_deg=0.0,
        focal_share=0.0,
    )
    design = state.design
    stiffer = 1.0 + rng.uniform(-1.0, 1.0) * tolerances.young_percent / 100.0
    thicker_mm = rng.uniform(-1.0, 1.0) * tolerances.wall_mm
    material = dataclasses.replace(
        design.material, young_MPa=round(stiffer * design.material.young_MPa, 9)
    )
    wall_mm = round(max(LEAST_WALL_MM, design.layers.elastomer_mm + thicker_mm), 6)
    layers = dataclasses.replace(design.layers, elastomer_mm=wall_mm)
    built = dataclasses.replace(
        design, material=material, layers=layers, optics=assembled(design.optics, looks, rng)
    )
    return State(design=built, case=state.case)
