"""The studio of a design: its light and the table of it from the store, or traced first."""

from __future__ import annotations

from typing import TYPE_CHECKING

from workbench.calibration.stored import stored
from workbench.core.base.monitor import Monitor, part
from workbench.core.design.design import SensorDesign
from workbench.core.press.press_case import PressCase
from workbench.core.result.results import MembraneMesh
from workbench.pipeline.devices import start_device
from workbench.pipeline.stages import table
from workbench.pipeline.store import Store
from workbench.planning.plan import InlineRunner, plan

if TYPE_CHECKING:
    from sim.optics.studio.render import Studio


def lit_studio(
    design: SensorDesign, mesh: MembraneMesh, store: Store, monitor: Monitor, what: str
) -> Studio:
    """Camera and light of a design whose light model looks radiance up.

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
