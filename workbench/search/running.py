"""A whole search with its files: the loop, the front as it grows, finalists, the report."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from workbench.core.base.errors import Cancelled
from workbench.core.base.monitor import Monitor, part, silent
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
) -> Found:
    """Search, confirm the front, and write all files; a search that is there already goes on.

    The front is written after every trial. One that is stopped writes its report too, with nothing
    confirmed and nothing said of what matters, since whoever stops does not wait.

    Raises:
        DesignError: If the folder holds another search.
        SearchError: If nearly every proposal is refused.
        Cancelled: If the user asked to stop.
    """
    evaluator = DesignEvaluator(problem, project)
    span = part(monitor, 0.0, 0.9)

    def noted(told: Told) -> None:
        found = found_of(problem, told.study)
        write_front(out, found, finalists(found, project, confirm=False), project)
        on_trial(told)

    try:
        search(problem, evaluator, out / FILE, budget, monitor=span, on_trial=noted)
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
