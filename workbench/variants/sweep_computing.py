"""Computes the points of a sweep in this process."""

from __future__ import annotations

import time
from collections.abc import Callable

from workbench.core.base.errors import Cancelled, WorkbenchError
from workbench.pipeline.stage import Outcome
from workbench.planning.plan import InlineRunner, StageMonitor, evaluate
from workbench.project.project import Project
from workbench.variants.sweeps import Sweep, done, failed, state_at


def compute(
    what: Sweep,
    project: Project,
    *,
    monitor: StageMonitor | None = None,
    on_outcome: Callable[[Outcome], None] = lambda outcome: None,
    on_point: Callable[[Sweep, int, float], None] = lambda what, number, seconds: None,
) -> Sweep:
    """All points in order; one that fails is kept as such, and the next is computed.

    Args:
        what: The sweep; points that are stored cost nothing.
        project: Where results are kept.
        monitor: Told how far a stage is.
        on_outcome: Told each stage that is done.
        on_point: Told the sweep, the number of the point that is done or failed, and its seconds.

    Raises:
        Cancelled: If the user asked to stop; finished results are stored.
    """
    runner = InlineRunner(project.store)
    for number in range(len(what.points)):
        started = time.monotonic()
        try:
            state = state_at(what, number)
            for outcome in evaluate(
                state.design, state.case, runner, wanted=what.wanted, monitor=monitor
            ):
                on_outcome(outcome)
            what = done(what, number, project.store, time.monotonic() - started)
        except Cancelled:
            raise
        except WorkbenchError as error:
            what = failed(what, number, error)
        on_point(what, number, time.monotonic() - started)
    return what
