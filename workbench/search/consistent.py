"""Whether a search can have a solution, as far as that is known before anything is computed."""

from __future__ import annotations

from sim.optics.field.model import model_of
from workbench.core.base.errors import DesignError
from workbench.planning.plan import plan
from workbench.search.applying import followed, state_of
from workbench.search.even_light import POWERS
from workbench.search.problem import Limit, Problem
from workbench.search.search_figures import BY_DESIGN, COST, KNOWN, LEDS, stages_of
from workbench.view.metric_rules import rule

MOST_GOALS, MOST_VARIED = 4, 30
"""Our choice: beyond these a Gaussian process learns little from a hundred trials."""
DECIDES = {
    LEDS: ("design.optics.ring.count",),
    "press_depth_mm": ("case.press.depth_mm",),
}
"""Fields that a figure follows from alone."""


def expect_consistent(problem: Problem) -> None:
    """Refuse a search that cannot have a solution.

    Raises:
        DesignError: Without goals or anything to vary; where a field stands twice; where a figure
            does not exist for the base; where limits exclude each other, or the base breaks one
            that nothing varied can mend.
    """
    _expect_some(problem)
    _expect_once(problem)
    _expect_figures(problem)
    for limit in problem.limits:
        _expect_possible(problem, limit)


def _expect_some(problem: Problem) -> None:
    if not problem.goals:
        hint = "write [[goal]] with figure and want, or a wish with goals"
        raise DesignError("the search has no goal", hint=hint, at="goal")
    if not problem.vary:
        hint = "write [[vary]] with field, low and high"
        raise DesignError("the search varies nothing", hint=hint, at="vary")
    for what, found, most in (
        ("goals", len(problem.goals), MOST_GOALS),
        ("varied fields", len(problem.vary), MOST_VARIED),
    ):
        if found > most:
            raise DesignError(
                f"{found} {what} are more than {most}", hint="make limits of some", at="search"
            )


def _expect_once(problem: Problem) -> None:
    seen: set[str] = set()
    paths = [*(vary.path for vary in problem.vary), *(link.path for link in problem.links)]
    paths += [POWERS] if problem.even_light else []
    for path in paths:
        if path in seen:
            raise DesignError(
                f"{path} is set twice", hint="vary it, link it, or solve for it", at=path
            )
        seen.add(path)
    goals = [goal.figure for goal in problem.goals]
    for name in goals:
        if goals.count(name) > 1:
            raise DesignError(f"{name} is a goal twice", hint="remove one", at="goal.figure")
    # What the links make of the base must be a design: a wrong factor is told at once.
    for path in followed(problem, {}):
        if path in {link.follows for link in problem.links}:
            hint = "let both follow the same field"
            raise DesignError(f"{path} follows and is followed", hint=hint, at=path)


def _expect_figures(problem: Problem) -> None:
    # With the settings of trials: what they break would be refused in every one.
    state = state_of(problem, {}, draft=True)
    names = tuple(each.figure for each in (*problem.goals, *problem.limits))
    calls = plan(state.design, state.case)
    model = model_of(state.design.optics.light_model)
    for name in names:
        missing = [stage for stage in stages_of((name,)) if stage not in calls]
        paper = model.paper and name in ("light_evenness_p5_over_p95_1", "glare_percent")
        if missing or paper:
            raise DesignError(
                f"{rule(name).label} ({name}) does not exist for the base",
                hint=f"the light model {state.design.optics.light_model} has none; use hybrid",
                at=name,
            )
        if name == COST and problem.prices is None:
            hint = "write [prices] with led, camera, gram and base, or set My prices on Compare"
            raise DesignError(f"{name} needs prices", hint=hint, at="prices")


def _expect_possible(problem: Problem, limit: Limit) -> None:
    least, most = limit.at_least, limit.at_most
    if least is not None and most is not None and least > most:
        raise DesignError(
            f"the limit of {limit.figure} allows nothing: {limit.words}",
            hint="at_least must not be more than at_most",
            at="limit",
        )
    if limit.figure not in BY_DESIGN:
        return
    changed = {vary.path for vary in problem.vary} | {link.path for link in problem.links}
    if changed & set(DECIDES[limit.figure]):
        return
    state = state_of(problem, {})
    optics = state.design.optics
    now = {
        LEDS: float(optics.ring.count + len(optics.lamps)),
        "press_depth_mm": state.case.press.depth_mm,
    }[limit.figure]
    if limit.excess(now) > 0.0:
        unit = KNOWN[limit.figure].unit
        raise DesignError(
            f"{KNOWN[limit.figure].label} is {now:g} {unit} in the base, the limit {limit.words}, "
            "and nothing that varies changes it",
            hint=f"vary {DECIDES[limit.figure][0]}, or change the limit",
            at="limit",
        )
