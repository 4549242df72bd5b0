"""A result of the chain from the store, computed first where it is not there."""

from __future__ import annotations

from typing import Any

from workbench.core.base.monitor import Monitor
from workbench.core.design.design import SensorDesign
from workbench.core.press.press_case import PressCase
from workbench.pipeline.store import Store
from workbench.planning.plan import InlineRunner, evaluate, plan


def stored(
    design: SensorDesign, case: PressCase, stage: str, store: Store, monitor: Monitor
) -> Any:
    """The result of a stage.

    Raises:
        WorkbenchError: From the first stage that fails; what was done before stays stored.
    """

    def told(stage: str, fraction: float, note: str) -> None:
        monitor(fraction, note or stage)

    for _ in evaluate(design, case, InlineRunner(store), wanted=(stage,), monitor=told):
        pass
    return store.load(stage, plan(design, case)[stage].key)
