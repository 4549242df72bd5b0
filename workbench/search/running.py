"""A whole search with its files: the loop, the front as it grows, finalists, the report."""

from __future__ import annotations

import threading
from collections.abc import Callable
from pathlib import Path

from workbench.cluster.spreading import Spread, spread
from workbench.core.base.errors import Cancelled
from workbench.core.base.monitor import Monitor, part, silent
from workbench.planning.plan import InlineRunner
from workbench.project.project import Project
from workbench.search.evaluator import DesignEvaluator
from workbench.search.finalists import finalists
from workbench.search.front import Found, found_of, importance
from workbench.search.journal import FILE, open_study
from workbench.search.loop import Budget, Told, search
from workbench.search.outputs import REPORT, write_front
from workbench.search.problem import Problem
from workbench.search.report import report_page
from workbench.system.whole_files import write_atomically


def run_search(
    problem: Problem,
    project: Project,
    out: Path,
    budget: Budget,
    *,
    monitor: Monitor = silent,
    on_trial: Callable[[Told], None] = lambda told: None,
    spread_on: Spread | None = None,
) -> Found:
    """Search, confirm the front, and write all files; a search that is there already goes on.

    On a cluster so many trials are under way at once as it has workers; each thread works on the
    search as a process of its own would.

    The front is written after every trial. One that is stopped writes its report too, with nothing
    confirmed and nothing said of what matters, since whoever stops does not wait.

    Raises:
        DesignError: If the folder holds another search.
        SearchError: If nearly every proposal is refused.
        Cancelled: If the user asked to stop.
    """
    on = spread_on or Spread(runner=InlineRunner(project.store), width=1)
    span, writing = part(monitor, 0.0, 0.9), threading.Lock()

    def noted(told: Told) -> None:
        with writing:
            found = found_of(problem, told.study)
            write_front(out, found, finalists(found, project, confirm=False), project)
            on_trial(told)

    def work(number: int) -> None:
        evaluator = DesignEvaluator(problem, project, runner=on.runner)
        search(problem, evaluator, out / FILE, budget, monitor=span, on_trial=noted)

    try:
        for _ in spread(work, range(on.width), on):
            pass
        return write_results(problem, project, out, monitor=part(monitor, 0.9, 1.0))
    except (Cancelled, KeyboardInterrupt):
        write_results(problem, project, out, confirm=False)
        raise


def write_results(
    problem: Problem,
    project: Project,
    out: Path,
    *,
    confirm: bool = True,
    monitor: Monitor = silent,
) -> Found:
    """Write front, designs, table and report of a search as its journal has it.

    Args:
        problem: The search.
        project: Where results are kept.
        out: Its folder.
        confirm: Whether to confirm the front, and to tell what matters.
        monitor: Progress and cancellation.

    Raises:
        StoreError: If the folder cannot be written.
    """
    study = open_study(problem, out / FILE)
    found = found_of(problem, study)
    listed = finalists(found, project, confirm=confirm, monitor=monitor)
    write_front(out, found, listed, project)
    shares = importance(found, study) if confirm else {}
    write_atomically(out / REPORT, report_page(found, listed, shares, project.store).encode())
    return found
