"""`workbench sweep`: one number of a design in steps, as plot data and report.

Writes `sweep.json` (every point with value, status, figures and keys), `sweep.csv` (the same
figures as a table) and `sweep.html`. Results are stored: a sweep that was stopped and is asked for
again goes on where it was.
"""

from __future__ import annotations

import argparse
import csv
import io
import json
from pathlib import Path
from typing import Any

from workbench.cli.body_arguments import add_body_options
from workbench.cli.cluster_option import add_cluster_option, cluster_of
from workbench.cli.command import Command
from workbench.cli.held_state import base_state
from workbench.cli.options import OUT
from workbench.cli.press_arguments import (
    add_press_options,
)
from workbench.core.base.errors import (
    DesignError,
    shown,
)
from workbench.core.base.mapping import suggest
from workbench.core.base.units import human_seconds
from workbench.project.project import Project
from workbench.system.terminal import Progress, complain, say
from workbench.system.whole_files import write_atomically
from workbench.variants.sweep_computing import compute
from workbench.variants.sweeps import Span, Status, Sweep, make_sweep, metrics_of

FILES = ("sweep.json", "sweep.csv", "sweep.html")


def options(sub: argparse.ArgumentParser) -> None:
    """What may be typed behind it."""
    sub.add_argument("design", metavar="NAME|FILE", help="a file brings its press")
    add_body_options(sub)
    text = "for example design.shape.length_mm or case.press.depth_mm"
    sub.add_argument("--field", required=True, metavar="FIELD", help=text)
    text = "first value, in the field's own unit"
    sub.add_argument("--from", dest="start", required=True, type=float, metavar="VALUE", help=text)
    text = "last value"
    sub.add_argument("--to", dest="stop", required=True, type=float, metavar="VALUE", help=text)
    sub.add_argument("--steps", type=int, default=5, help="2 to 15, both ends included (default 5)")
    sub.add_argument("--metric", metavar="NAME", help="figure of the plot (default: mean change)")
    sub.add_argument("--parts", action="store_true", help="also mould and housing, for checks")
    add_press_options(sub)
    add_cluster_option(sub)
    sub.add_argument("--out", required=True, type=Path, metavar="DIR", help=OUT)
    sub.add_argument("--json", action="store_true", help="progress as one JSON object per line")


def run(options: argparse.Namespace, project: Project) -> int:
    """Run a design at several values of one parameter; write figures, plot and images."""
    from workbench.system.folder import prepare
    from workbench.variants.comparison_report import sweep_page
    from workbench.view.metric_rules import RULES

    if options.metric and options.metric not in RULES:
        hint = suggest(options.metric, RULES)
        raise DesignError(f"there is no figure {shown(options.metric)}", hint=hint, at="--metric")
    printer = Progress(as_json=options.json)
    what = make_sweep(
        "sweep",
        base_state(options, project, printer),
        options.field,
        Span(start=options.start, stop=options.stop, steps=options.steps),
        parts=options.parts,
    )
    prepare(options.out, clear=FILES)
    project.sweep()
    callbacks = {} if options.json else {"on_point": say_point}
    with cluster_of(options.cluster, project.store, printer) as on:
        what = compute(
            what, project, monitor=printer, on_outcome=printer.done, spread_on=on, **callbacks
        )
    contents = {
        "sweep.json": json.dumps(sweep_table(what), indent=1, allow_nan=False),
        "sweep.csv": sweep_csv(what),
        "sweep.html": sweep_page(project.store, what, options.metric or ""),
    }
    for name, content in contents.items():
        write_atomically(options.out / name, content.encode())
    if options.json:
        say(json.dumps(sweep_table(what), allow_nan=False))
    else:
        say(f"open {options.out / 'sweep.html'}")
    return 0 if all(point.status is Status.DONE for point in what.points) else 3


def say_point(what: Sweep, number: int, seconds: float) -> None:
    """One line about a point that is done or failed."""
    point = what.points[number]
    words = point.message or "done"
    spent = human_seconds(seconds)
    complain(f"{number + 1} of {len(what.points)}: {point.value:g} {words}, {spent}")


def sweep_table(what: Sweep) -> dict[str, Any]:
    """A sweep as plain tables."""
    return {
        "schema": 1,
        "design": what.base.design.name,
        "family": what.base.design.family,
        "field": what.path,
        "label": what.field.label,
        "unit": what.field.unit,
        "points": [
            {
                "value": point.value,
                "status": point.status.value,
                "message": point.message,
                "figures": dict(point.figures),
                "keys": dict(point.keys),
            }
            for point in what.points
        ],
    }


def sweep_csv(what: Sweep) -> str:
    """Values and figures as comma-separated values; what a point has not is empty."""
    names = metrics_of(what)
    buffer = io.StringIO()
    writer = csv.writer(buffer, lineterminator="\n")
    writer.writerow([what.path.rpartition(".")[2], "status", *names])
    for point in what.points:
        figures = [point.figures.get(name, "") for name in names]
        writer.writerow([point.value, point.status.value, *figures])
    return buffer.getvalue()


COMMAND = Command(place=8, run=run, options=options)
