"""A press by finite elements from a design: solved through the store, or ready to be a deck.

A deck carries design and press in its comments, so that the results of other programs can be read
and compared without naming the case again.
"""

from __future__ import annotations

import dataclasses
import json
from typing import TYPE_CHECKING, Any

from workbench.core.base.errors import DesignError, StoreError, WorkbenchError
from workbench.core.result.force_field import ForceField
from workbench.core.result.results import MembraneMesh
from workbench.core.result.sampled import SampledDistance
from workbench.pipeline.stages import fem
from workbench.planning.foresight import expect_fit
from workbench.planning.plan import InlineRunner, StageMonitor, evaluate, plan, stage_monitor
from workbench.project.design_toml import design_to_toml
from workbench.project.project import Project
from workbench.project.state import State, case_table, read_state
from workbench.system.terminal import Progress

if TYPE_CHECKING:
    from sim.fem.decks.deck import DeckCase
    from sim.fem.decks.mesh import Element

STAGE = "fem"
SCHEMA = 1
"""Of what a deck carries."""


def solved(state: State, project: Project, printer: Progress) -> ForceField:
    """Our result of a press: from the store, or solved and stored.

    Raises:
        WorkbenchError: If body, mesh or object cannot be made, or an increment does not converge.
    """
    runner, store = InlineRunner(project.store), project.store
    for outcome in evaluate(state.design, state.case, runner, wanted=("build",), monitor=printer):
        printer.done(outcome)
    # A depth that no wall has is said before the body is meshed.
    build = plan(state.design, state.case)["build"]
    expect_fit(store.load(build.stage, build.key), None, state.case)
    for outcome in evaluate(state.design, state.case, runner, wanted=(STAGE,), monitor=printer):
        if outcome.stage != build.stage:
            printer.done(outcome)
    return project.store.load(STAGE, plan(state.design, state.case)[STAGE].key)


def deck_case(
    state: State, element: Element, project: Project, monitor: StageMonitor | None = None
) -> tuple[DeckCase, MembraneMesh]:
    """A press ready to be written as a deck, and the membrane at the spacing of finite elements.

    Raises:
        WorkbenchError: If a part cannot be made, the object is soft or it stays off the skin.
    """
    runner, store = InlineRunner(project.store), project.store
    for _ in evaluate(state.design, state.case, runner, wanted=("build",), monitor=monitor):
        pass
    found: dict[str, Any] = {}
    for name, call in fem.parts(plan(state.design, state.case)[STAGE].inputs, store).items():
        runner.run(call, stage_monitor(monitor, call.stage))
        found[name] = store.load(call.stage, call.key)
    mesh = found["mesh"]
    return make_deck_case(mesh, state, element, sampled=found.get("sampled")), mesh


def make_deck_case(
    mesh: MembraneMesh, state: State, element: Element, *, sampled: SampledDistance | None = None
) -> DeckCase:
    """As `deck_case`, with the membrane at hand."""
    from sim.fem.contact_law import PENALTY, Law
    from sim.fem.decks.deck import DeckCase
    from sim.fem.decks.rigid_object import make_shell, near_box_mm, near_surface
    from sim.fem.press import set_up
    from workbench.pipeline.devices import open_device

    if sampled is not None:
        # A large object is sampled once more where it meets the skin.
        open_device()
    material = state.design.material
    if material.sliding_friction < material.friction:
        raise DesignError(
            f"a deck has one coefficient of friction, and this design has kinetic friction "
            f"{material.sliding_friction:g} below {material.friction:g}",
            hint="set material.kinetic_friction to that of material.friction for the deck",
            at="material.kinetic_friction",
        )
    # Other programs know no hanging nodes.
    whole = dataclasses.replace(state.case.fem, halvings=0)
    case = dataclasses.replace(state.case, fem=whole)
    approach, submodel = set_up(mesh, material, case, sampled=sampled)
    skin_mm = submodel.body.points_mm[submodel.marks.outer >= 0]
    surface = near_surface(approach.collider, *near_box_mm(skin_mm, approach))
    return DeckCase(
        submodel=submodel,
        approach=approach,
        material=material,
        law=Law(penalty_MPa_mm=PENALTY * material.young_MPa, friction=material.friction),
        shell=make_shell(*surface, approach.collider),
        element=element,
    )


def carried(state: State, element: Element, project: Project) -> str:
    """Design and press as text that a deck carries."""
    project.keep_files(state.design)
    press = case_table(state.case, project)
    table: dict[str, Any] = {
        "schema": SCHEMA,
        "element": element.value,
        "design": design_to_toml(state.design, press_case=press),
    }
    return json.dumps(table)


def read_carried(text: str, project: Project, *, source: str) -> tuple[State, Element]:
    """What `carried` wrote.

    Raises:
        StoreError: If the text is damaged or of another version.
    """
    from sim.fem.decks.mesh import Element

    try:
        table = json.loads(text)
        if table["schema"] != SCHEMA:
            raise ValueError(f"schema {table['schema']}, expected {SCHEMA}")
        return read_state(table["design"], project, source=source), Element(table["element"])
    except (ValueError, KeyError, TypeError, WorkbenchError) as error:
        raise StoreError(
            f"{source} was written by another version, or edited: {error}",
            hint="export it again",
        ) from error
