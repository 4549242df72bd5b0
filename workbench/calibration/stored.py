"""Results of the chain from the store, computed first where they are not there."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from workbench.core.base.monitor import Monitor, part
from workbench.core.design.design import SensorDesign
from workbench.core.press.press_case import PressCase
from workbench.core.result.results import MembraneMesh
from workbench.pipeline.devices import start_device
from workbench.pipeline.stages import table
from workbench.pipeline.store import Store
from workbench.planning.plan import InlineRunner, evaluate, needed, plan

if TYPE_CHECKING:
    from sim.optics.studio.render import Studio


def stored(
    design: SensorDesign, case: PressCase, stage: str, store: Store, monitor: Monitor
) -> Any:
    """The result of a stage.

    Raises:
        WorkbenchError: From the first stage that fails; what was done before stays stored.
    """

    calls = plan(design, case)
    missing = [each for each in needed(calls, (stage,)) if not store.has(each, calls[each].key)]

    def told(stage: str, fraction: float, note: str) -> None:
        done = missing.index(stage) if stage in missing else 0
        monitor((done + fraction) / max(len(missing), 1), note or stage)

    for _ in evaluate(design, case, InlineRunner(store), wanted=(stage,), monitor=told):
        pass
    return store.load(stage, calls[stage].key)


def lit_studio(
    design: SensorDesign, mesh: MembraneMesh, store: Store, monitor: Monitor, what: str
) -> Studio:
    """The studio of a design whose light model looks radiance up: light and table come from here.

    Args:
        mesh: Of the design.
        store: Keeps light and table.
        monitor: Progress and cancellation.
        what: What the light is for, for people.

    Raises:
        WorkbenchError: From the stages that trace.
    """
    start_device(monitor)
    from sim.optics.studio.render import Studio

    def told(fraction: float, note: str = "") -> None:
        monitor(0.8 * fraction, f"{what}: {note}")

    light, optics = stored(design, PressCase(), "bake", store, told), design.optics
    calls = plan(design, PressCase())
    inputs = table.table_inputs(optics, calls["mesh"].ref, calls["bake"].ref)
    if inputs is None:
        raise ValueError(f"the light model {optics.light_model} looks nothing up")
    call = table.STAGE.call(inputs)
    InlineRunner(store).run(call, part(monitor, 0.8, 1.0))
    return Studio(mesh, light, optics, table=store.load("table", call.key))
