"""Several designs: one number in steps, two side by side, those that a search by goals finds."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from workbench.core.base.monitor import Monitor, silent
from workbench.core.base.packages import naming_packages
from workbench.door.results import Results
from workbench.project.project import Project
from workbench.search.front import Found
from workbench.variants.comparison import Change, changes
from workbench.variants.sweep_computing import compute
from workbench.variants.sweeps import Span, Sweep, make_sweep


def sweep(base: Results, field: str, start: float, stop: float, steps: int = 5) -> Sweep:
    """Figures of a design at several values of one of its numbers.

    Results are stored: one that was stopped and is asked for again goes on where it was.

    Args:
        base: The design with its press, from `evaluate`.
        field: Dotted name, for example `layers.elastomer_mm` or `press.depth_mm`.
        start: First value, in the field's own unit.
        stop: Last value.
        steps: Values at equal distances, both ends included.

    Returns:
        The sweep; its `points` have `value`, `figures`, and `message` where a design was refused.

    Raises:
        DesignError: If the field cannot be swept, or every value is refused.
    """
    span = Span(start=start, stop=stop, steps=steps)
    what = make_sweep("sweep", base.state, field, span)
    return compute(what, base.project)


def compare(a: Results, b: Results, stages: Sequence[str] = ("shoot", "maps")) -> list[Change]:
    """Figures of two designs: `rule.name`, `a`, `b`, `percent`, and the `verdict` for B.

    Args:
        a: One design with its press.
        b: The other.
        stages: Computed for both; figures come from these and from what is stored.
    """
    for results in (a, b):
        results.compute(*stages)
    return changes(a.figures, b.figures)


def search_designs(
    file: Path | str,
    out: Path | str,
    *,
    trials: int | None = None,
    minutes: float = float("inf"),
    project: Project | Path | str | None = None,
    monitor: Monitor | None = None,
) -> Found:
    """Designs looked for by goals, as `workbench search` does it; what is in `out` goes on.

    Args:
        file: What may vary, what is wanted and what must hold, as TOML.
        out: Folder of the journal, the front and the report.
        trials: Designs to compute in all; the file's number when left out.
        minutes: No design is begun after so long.
        project: Folder that keeps results; `.workbench`, or `$WORKBENCH_PROJECT`, by default.
        monitor: Told fraction and note; one that raises `Cancelled` loses the running trial alone.

    Returns:
        All its `trials`, and of these the `front`: those within the limits that no other beats. Of
        each there are `judged.parameters` and `judged.figures` by name.

    Raises:
        DesignError: If the file says what cannot be searched, or `out` holds another search.
        PackageError: If a package is missing.
        WorkbenchError: If nearly every design is refused.
    """
    with naming_packages():
        from workbench.pipeline.devices import open_device
        from workbench.search.loop import Budget
        from workbench.search.problem_file import load_problem
        from workbench.search.running import run_search

        where = project if isinstance(project, Project) else Project(project)
        problem = load_problem(Path(file), where)
        wanted = problem.trials if trials is None else trials
        open_device()
        budget = Budget(trials=wanted, minutes=minutes)
        return run_search(problem, where, Path(out), budget, monitor=monitor or silent)
