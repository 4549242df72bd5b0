"""A press by finite elements from a design: its mesh from the store, solved, or written as a deck.

The membrane is meshed at the settings' own spacing, whatever the design is meshed at for images.
"""

from __future__ import annotations

import dataclasses
import json
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from workbench.core.design import SensorDesign
from workbench.core.digest import digest
from workbench.core.errors import StoreError, WorkbenchError
from workbench.core.fem import FemSettings
from workbench.core.force_field import ForceField
from workbench.core.mapping import from_table, to_table
from workbench.core.monitor import Monitor, silent
from workbench.core.results import MembraneMesh
from workbench.core.sampled import SampledDistance
from workbench.design_toml import design_to_toml
from workbench.pipeline import InlineRunner, PressCase, StageMonitor, at_defaults, evaluate, plan
from workbench.project import Project
from workbench.state import State, case_table, read_state
from workbench.store import timed

if TYPE_CHECKING:
    from sim.fem.deck import DeckCase
    from sim.fem.deck_mesh import Element

STAGE, VERSION = "fem", 0
"""Where the store keeps what `solved` found."""
SCHEMA = 1
"""Of what a deck carries."""


@dataclass(frozen=True, kw_only=True, slots=True)
class FemCase:
    """What is pressed, and how it is solved."""

    design: SensorDesign
    press: PressCase
    settings: FemSettings

    @property
    def state(self) -> State:
        """Design and press with the spacings that finite elements ask for."""
        from sim.fem.press import sampling_grid_mm

        design = self.design.replace("meshing.hex_mm", self.settings.hex_mm)
        contact = dataclasses.replace(
            self.press.settings, grid_mm=sampling_grid_mm(self.settings), active_radius_mm=0.0
        )
        return State(design=design, case=dataclasses.replace(self.press, settings=contact))


def solved(case: FemCase, project: Project, monitor: StageMonitor | None = None) -> ForceField:
    """Our result of a press: from the store, or solved and stored.

    Raises:
        WorkbenchError: If body, mesh or object cannot be made, or an increment does not converge.
    """
    from sim.fem.press import solve_press

    calls = plan(case.state.design, case.state.case)
    material = at_defaults(case.design.material, "density_g_cm3")
    inputs = (material, case.press.indenter, case.press.press, case.settings)
    key = digest((STAGE, VERSION, calls["mesh"].key, inputs))
    if project.store.has(STAGE, key):
        return project.store.load(STAGE, key)
    mesh, sampled = parts(case, project, monitor)
    watch = _watch(monitor)
    value, seconds = timed(solve_press, mesh, *inputs, sampled=sampled, monitor=watch)
    project.store.save(STAGE, key, value, seconds=seconds, version=VERSION)
    return value


def _watch(monitor: StageMonitor | None) -> Monitor:
    if monitor is None:
        return silent
    return lambda fraction, note="": monitor(STAGE, fraction, note)


def parts(
    case: FemCase, project: Project, monitor: StageMonitor | None = None
) -> tuple[MembraneMesh, SampledDistance | None]:
    """The membrane's mesh, and the object's distance where it has to be sampled.

    Raises:
        WorkbenchError: If one of them cannot be made.
    """
    state, store = case.state, project.store
    calls = plan(state.design, state.case)
    wanted = [name for name in ("mesh", "object") if name in calls]
    for _ in evaluate(
        state.design, state.case, InlineRunner(store), wanted=wanted, monitor=monitor
    ):
        pass
    found = [store.load(name, calls[name].key) for name in wanted]
    return found[0], found[1] if len(found) > 1 else None


def deck_case(
    case: FemCase, element: Element, project: Project, monitor: StageMonitor | None = None
) -> tuple[DeckCase, MembraneMesh]:
    """A press ready to be written as a deck, and its membrane.

    Raises:
        WorkbenchError: If a part cannot be made, the object is soft or it stays off the skin.
    """
    mesh, sampled = parts(case, project, monitor)
    return make_deck_case(mesh, case, element, sampled=sampled), mesh


def make_deck_case(
    mesh: MembraneMesh,
    case: FemCase,
    element: Element,
    *,
    sampled: SampledDistance | None = None,
) -> DeckCase:
    """As `deck_case`, with the membrane at hand."""
    from sim.fem.contact_law import PENALTY, Law
    from sim.fem.deck import DeckCase
    from sim.fem.deck_object import make_shell, near_box_mm
    from sim.fem.press import set_up
    from workbench.fem_surface import near_surface

    material, press = case.design.material, case.press
    collider, approach, submodel = set_up(
        mesh, material, press.indenter, press.press, case.settings, sampled=sampled
    )
    skin_mm = submodel.body.points_mm[submodel.skin >= 0]
    surface = near_surface(collider, *near_box_mm(skin_mm, approach, collider))
    return DeckCase(
        submodel=submodel,
        approach=approach,
        material=material,
        law=Law(penalty_MPa_mm=PENALTY * material.young_MPa, friction=material.friction),
        shell=make_shell(*surface, collider),
        element=element,
    )


def carried(case: FemCase, element: Element, project: Project) -> str:
    """Design, press and settings as text that a deck carries."""
    project.keep_files(case.design)
    table: dict[str, Any] = {
        "schema": SCHEMA,
        "element": element.value,
        "fem": to_table(case.settings),
        "design": design_to_toml(case.design, press_case=case_table(case.press, project)),
    }
    return json.dumps(table)


def read_carried(text: str, project: Project, *, source: str) -> tuple[FemCase, Element]:
    """What `carried` wrote.

    Raises:
        StoreError: If the text is damaged or of another version.
        DesignError: If the design is not valid any more.
    """
    from sim.fem.deck_mesh import Element

    try:
        table = json.loads(text)
        if table["schema"] != SCHEMA:
            raise ValueError(f"schema {table['schema']}, expected {SCHEMA}")
        element = Element(table["element"])
        settings = from_table(FemSettings, table["fem"], at="fem")
        design = table["design"]
    except (ValueError, KeyError, TypeError, WorkbenchError) as error:
        raise StoreError(
            f"{source} was written by another version, or edited: {error}",
            hint="export it again",
        ) from error
    state = read_state(design, project, source=source)
    return FemCase(design=state.design, press=state.case, settings=settings), element
