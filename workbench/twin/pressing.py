"""Paths pressed ahead by processes of their own, side by side, into the store.

What a process raises is kept with the path's name; who asks for the path then finds it in the
store, or the reason.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from workbench.core.base.errors import WorkbenchError
from workbench.core.base.monitor import Monitor, silent
from workbench.learning.making.side_by_side import side_by_side
from workbench.pipeline.store import Store
from workbench.twin.cases import TwinCase
from workbench.twin.contact import pressed
from workbench.twin.draw import Twin
from workbench.twin.twin_plan import TwinPlan


@dataclass(frozen=True, kw_only=True, slots=True)
class _Press:
    """Presses paths of one twin into a store."""

    twin: Twin
    plan: TwinPlan
    store: Path

    def __call__(self, case: TwinCase) -> str:
        """Press one; why not, else ""."""
        try:
            pressed(self.twin, self.plan, case, Store(self.store), silent)
        except WorkbenchError as error:
            return error.message
        return ""


def press_ahead(
    twin: Twin, plan: TwinPlan, cases: Sequence[TwinCase], store: Store, monitor: Monitor
) -> dict[str, str]:
    """Press paths side by side; returns those that failed, with the reason.

    Raises:
        Cancelled: If the monitor says so; the processes are ended, and what is stored stays.
        LaneError: If a process ended by itself.
    """

    def told(fraction: float, note: str = "") -> None:
        monitor(fraction, f"pressed {note} paths")

    press = _Press(twin=twin, plan=plan, store=store.root)
    reasons = side_by_side(press, cases, plan.jobs, told)
    return {case.id: why for case, why in zip(cases, reasons, strict=True) if why}
