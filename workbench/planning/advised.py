"""Which source of forces to trust for a planned press: what `pipeline.advice` must know of it."""

from __future__ import annotations

from collections.abc import Mapping

from sim.forces.contact_kind import kind_of_press
from workbench.core.press.press import Method
from workbench.core.press.press_case import PressCase
from workbench.pipeline.advice import Advice, Asked, Table, advice, table
from workbench.pipeline.stage import Call
from workbench.pipeline.stages.learned import foreknown, unmeasured


def advised(
    case: PressCase, calls: Mapping[str, Call], *, notice: str = "", known: Table | None = None
) -> Advice:
    """Errors of each source on presses like one, and which is the nearest.

    Args:
        case: The press.
        calls: Of its plan, by stage.
        notice: Of its learned forces, once there are some.
        known: What was measured; None: what ships.
    """
    return advice(asked(case, calls, notice=notice), table() if known is None else known)


def asked(case: PressCase, calls: Mapping[str, Call], *, notice: str = "") -> Asked:
    """A planned press, as far as errors depend on it."""
    settings, given = case.settings, None
    if "learned" in calls:
        given = calls["learned"].inputs
    beyond = () if given is None else unmeasured(given, notice)
    return Asked(
        kind=kind_of_press(case.indenter, case.press),
        network="" if given is None else given.force.file.name,
        seen=given is None or set(foreknown(given)) <= set(beyond),
        foreign=bool(beyond),
        grid_mm=settings.grid_mm if settings.method is Method.LATTICE else 0.0,
        solvable="forces" in calls and case.indenter.soft is None,
    )
