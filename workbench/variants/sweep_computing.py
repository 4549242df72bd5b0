"""Computes the points of a sweep, one after the other here or side by side on a cluster."""

from __future__ import annotations

import time
from collections.abc import Callable

from workbench.cluster.spreading import Spread, spread
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
    spread_on: Spread | None = None,
) -> Sweep:
    """All points; one that fails is kept as such, and the others are computed.

    Args:
        what: The sweep; points that are stored cost nothing.
        project: Where results are kept.
        monitor: Told how far a stage is.
        on_outcome: Told each stage that is done.
        on_point: Told the sweep, the number of the point that is done or failed, and its seconds.
        spread_on: Computes points side by side; one after the other in this process by default.

    Raises:
        Cancelled: If the user asked to stop; finished results are stored.
    """
    on = spread_on or Spread(runner=InlineRunner(project.store), width=1)

    def point(number: int) -> tuple[WorkbenchError | None, float]:
        started = time.monotonic()
        try:
            state = state_at(what, number)
            for outcome in evaluate(
                state.design, state.case, on.runner, wanted=what.wanted, monitor=monitor
            ):
                on_outcome(outcome)
        except Cancelled:
            raise
        except WorkbenchError as error:
            return error, time.monotonic() - started
        return None, time.monotonic() - started

    for number, (error, seconds) in spread(point, range(len(what.points)), on):
        try:
            if error is not None:
                raise error
            what = done(what, number, project.store, seconds)
        except WorkbenchError as why:
            what = failed(what, number, why)
        on_point(what, number, seconds)
    return what
