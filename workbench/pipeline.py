"""From a design and a press to every result: used by the command line and the browser alike.

`plan` names all calls and keys without computing anything; `evaluate` runs them in order through a
runner (in this process, or in worker lanes) and yields each outcome.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from typing import Any, Protocol, TypeVar

from workbench.bodies import IMPORTED, check_body
from workbench.core.design import Elastomer, SensorDesign
from workbench.core.errors import DamagedError
from workbench.core.fem import FemSettings
from workbench.core.indenter import EDGELESS, Indenter
from workbench.core.learned import LearnedSettings
from workbench.core.lighting import LedRing
from workbench.core.monitor import Monitor, silent
from workbench.core.press import ContactSettings, Press
from workbench.force_calls import fem_calls, learned_calls
from workbench.light_calls import bake_call, maps_calls, seen_optics, table_calls
from workbench.stages import STAGES, Call, Outcome, run
from workbench.store import Store
from workbench.surface_detail import detailed

Design = TypeVar("Design", Elastomer, LedRing, Indenter)

NEEDED = (
    "build",
    "mesh",
    "lattice",
    "bake",
    "press",
    "shoot",
    "mould",
    "housing",
    "recipe",
    "package",
)
"""Stages of a whole run, in order."""
EVERYTHING = (*NEEDED, "maps", "quality", "tets", "picture")
"""All stages; a machine without an off-screen renderer cannot run the last."""


@dataclass(frozen=True, kw_only=True, slots=True)
class PressCase:
    """What is pressed, where, and how it is computed."""

    indenter: Indenter = field(default_factory=Indenter)
    press: Press = field(default_factory=Press)
    settings: ContactSettings = field(default_factory=ContactSettings)
    fem: FemSettings = field(default_factory=FemSettings)
    learned: LearnedSettings = field(default_factory=LearnedSettings)


class Runner(Protocol):
    """Executes calls somewhere."""

    def run(self, call: Call, monitor: Monitor) -> Outcome:
        """Compute the call unless it is stored."""
        ...


class InlineRunner:
    """Runs calls in this process."""

    def __init__(self, store: Store) -> None:
        self.store = store

    def run(self, call: Call, monitor: Monitor) -> Outcome:
        """Compute the call here unless it is stored."""
        return run(self.store, call, monitor)


class StageMonitor(Protocol):
    """Progress of one named stage."""

    def __call__(self, stage: str, fraction: float, note: str) -> None:
        """Report that `fraction` of `stage` is done."""
        ...


def plan(design: SensorDesign, case: PressCase) -> dict[str, Call]:
    """Every call of the chain by stage name, in the order of `EVERYTHING`.

    A design with a body of its own has the call `intake` before them, a press of an object whose
    signed distance takes long to sample the call `object`; where there is a trained network, there
    is the call `learned`.

    Raises:
        DesignError: If the family or the silicone is unknown, or the family refuses the shape.
    """
    from designs.family import family, resolve_shape
    from geometry.silicones import silicone

    shape = resolve_shape(design.family, design.shape)
    family(design.family).check(shape, design.layers)
    check_body(design)
    silicone(design.casting.silicone)
    sources: tuple[Call, ...] = ()
    build = Call("build", (design.family, shape, design.layers))
    if design.body is not None and design.family == IMPORTED:
        intake = Call("intake", (dataclasses.replace(design.body, picks=()),))
        inputs = (design.family, shape, design.layers, intake.ref, design.body.picks)
        sources, build = (intake,), Call("build", inputs)
    mesh = Call("mesh", (build.ref, design.meshing))
    quality = Call("quality", (build.ref, mesh.ref))
    tets = Call("tets", (build.ref, design.meshing.tet_mm))
    lattice = Call("lattice", (build.ref, case.settings.grid_mm))
    material, optics, eye = design.material, design.optics, design.optics.camera
    elastic = at_defaults(material, "density_g_cm3")
    objects = tuple(
        Call("object", (_shape(indenter), case.settings.grid_mm))
        for indenter in (case.indenter,)
        if indenter.mesh is not None or indenter.texture.raised
    )
    pressed = (mesh.ref, lattice.ref, elastic, case.indenter, case.press, case.settings)
    press = Call("press", (*pressed, *(call.ref for call in objects)))
    path = (case.indenter, case.press)
    fem = fem_calls(build.ref, mesh.ref, elastic, *path, case.fem)
    known = (design, build.ref, mesh.ref, press.ref, elastic)
    learned = learned_calls(*known, *path, case.settings, case.learned)
    bake, seen = bake_call(optics, mesh.ref), seen_optics(optics)
    tables = table_calls(seen, mesh.ref, bake.ref)
    shown = detailed(optics, case.indenter, case.settings)
    fine = (None, 0.0) if shown is None else (_shape(shown), material.poisson)
    shoot = Call("shoot", (mesh.ref, bake.ref, seen, press.ref, material.young_MPa, *fine))
    maps = maps_calls(seen, mesh.ref, bake.ref, material.young_MPa)
    mould = Call("mould", (build.ref, design.mould))
    unbuilt = ("power", "powers", "emission_exponent", "cone_deg", "size_mm")
    coloured = at_defaults(optics.ring, *unbuilt)
    dark = at_defaults(coloured, "colours")
    pose = (eye.position_mm, eye.wxyz)
    housing = Call("housing", (build.ref, design.housing, dark, *pose, design.mould.printer))
    bought = (coloured, design.casting, material.young_MPa, material.density_g_cm3)
    recipe = Call("recipe", (build.ref, mould.ref, housing.ref, *bought, material.backing_MPa))
    head = (design.name, design.family, design.mould.shrink_percent, design.mould.draft_deg)
    package = Call("package", (mould.ref, housing.ref, recipe.ref, *head))
    picture = Call("picture", (build.ref, mould.ref, housing.ref))
    calls = (
        *sources,
        build,
        mesh,
        lattice,
        bake,
        *tables,
        *objects,
        press,
        *fem,
        *learned,
        shoot,
        *maps,
        mould,
        housing,
        recipe,
        package,
        quality,
        tets,
        picture,
    )
    return {call.stage: call for call in calls}


def _shape(indenter: Indenter) -> Indenter:
    """An object without what its signed distance does not read."""
    unread = ("soft", "edge_radius_mm") if indenter.kind in EDGELESS else ("soft",)
    return at_defaults(indenter, *unread)


def at_defaults(value: Design, *names: str) -> Design:
    """A part of the design with the fields a stage does not read at their defaults.

    The stage's key then does not hold them, so that changing them cannot re-run it.
    """
    fields = {item.name: item.default for item in dataclasses.fields(value)}
    return dataclasses.replace(value, **{name: fields[name] for name in names})


def needed(calls: dict[str, Call], wanted: Iterable[str]) -> list[str]:
    """The wanted stages and all they depend on, in order; those a design has not are left out."""
    todo: set[str] = set()

    def visit(name: str) -> None:
        todo.add(name)
        for value in calls[name].inputs:
            stage = getattr(value, "stage", None)
            if stage in calls:
                visit(stage)

    for name in wanted:
        if name in calls or name not in STAGES:
            visit(name)
    return [name for name in calls if name in todo]


def evaluate(
    design: SensorDesign,
    case: PressCase,
    runner: Runner,
    *,
    wanted: Iterable[str] = NEEDED,
    monitor: StageMonitor | None = None,
) -> Iterator[Outcome]:
    """Run the wanted stages and what they need; yield each outcome as it comes.

    A result that turns out to be damaged when a later stage reads it is computed again.

    Raises:
        WorkbenchError: From the first stage that fails; earlier results stay stored.
    """
    calls = plan(design, case)
    names = needed(calls, wanted)
    waiting, healed = list(names), 0
    while waiting:
        try:
            yield runner.run(calls[waiting[0]], stage_monitor(monitor, waiting[0]))
        except DamagedError as error:
            # Each time one is set aside: more often than there are stages is another fault.
            healed += 1
            if healed > len(names):
                raise
            waiting = [name for name in (error.at,) if name in calls] + waiting
        else:
            del waiting[0]


def stage_monitor(monitor: StageMonitor | None, stage: str) -> Monitor:
    """A stage's own monitor that reports under its name."""
    if monitor is None:
        return silent
    return lambda fraction, note="": monitor(stage, fraction, note)


def results(store: Store, calls: dict[str, Call], names: Iterable[str]) -> dict[str, Any]:
    """Stored results by stage name; stages that have not run are left out."""
    return {
        name: store.load(name, calls[name].key)
        for name in names
        if store.has(name, calls[name].key)
    }
