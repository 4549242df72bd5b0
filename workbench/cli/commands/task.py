"""`workbench task`: what a design can tell apart by touch, learned from renders."""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

from workbench.cli.cluster_option import add_cluster_option, open_cluster
from workbench.cli.command import Command
from workbench.cli.options import DESIGN, OUT
from workbench.cli.press_arguments import add_set_option
from workbench.core.base.errors import DesignError
from workbench.core.base.records import names
from workbench.project.project import Project
from workbench.system.terminal import Progress, say

if TYPE_CHECKING:
    from workbench.core.design.design import SensorDesign
    from workbench.tasks.run import Plan

SIZES = ("small", "paper")
NETWORKS = ("small", "paper")


def options(sub: argparse.ArgumentParser) -> None:
    """What may be typed behind it."""
    text = "what is told: the object, slip, the safety of the skin, the place, the force"
    sub.add_argument("task", choices=names("workbench.tasks.kinds"), help=text)
    sub.add_argument("design", metavar="NAME|FILE", help=DESIGN)
    sub.add_argument("--out", required=True, type=Path, metavar="DIR", help=OUT)
    text = "small: minutes on two cores; paper: as many presses as the paper, for a GPU (small)"
    sub.add_argument("--size", choices=SIZES, default=SIZES[0], help=text)
    text = (
        "small: of objects and safety the dent that is read, of slip the motion of the skin, of "
        "places and forces EfficientNet-Lite0 where its packages are, else seven convolutions; "
        "paper: ResNet50, VGG19 and LSTM (default: small)"
    )
    sub.add_argument("--network", choices=NETWORKS, default=NETWORKS[0], help=text)
    text = "folder of own photographs with idle.png and labels.csv, which are tested on too"
    sub.add_argument("--photos", type=Path, metavar="DIR", help=text)
    text = "folder of presses of another task of the same recipe (default: in --out)"
    sub.add_argument("--data", type=Path, metavar="DIR", help=text)
    sub.add_argument("--no-twin", action="store_true", help="no test on a twin's photographs")
    sub.add_argument("--jobs", type=int, default=1, metavar="N", help="processes (default 1)")
    add_cluster_option(sub)
    add_set_option(sub)
    sub.add_argument("--json", action="store_true", help="progress and results as JSON lines")


def run(options: argparse.Namespace, project: Project) -> int:
    """Learn a task from renders of a design, and test it on renders, a twin and photographs."""
    if options.jobs < 1:
        raise DesignError(
            f"{options.jobs} processes make nothing", hint="use --jobs 1 or more", at="--jobs"
        )
    from workbench.edit.typed_fields import with_typed
    from workbench.project.named_designs import load_design
    from workbench.system.folder import prepare
    from workbench.tasks.features import usual_network
    from workbench.tasks.result_file import FILES, REPORT, write_result
    from workbench.tasks.run import Plan, run_task
    from workbench.tasks.task import Net, Size, task_of
    from workbench.variants.kept_tasks import keep

    design = with_typed(load_design(options.design, project=project), options.set)
    plan = Plan(
        task=options.task,
        size=Size(options.size),
        net=usual_network(task_of(options.task)) if options.network == NETWORKS[0] else Net.PAPER,
        photos=options.photos,
        data=options.data,
        jobs=options.jobs,
        twin=not options.no_twin,
    )
    prepare(options.out, clear=FILES)
    project.sweep()
    printer = Progress(as_json=options.json)
    if options.cluster is not None:
        press_on_cluster(design, plan, options, project, printer)
    result = run_task(
        design,
        plan,
        options.out,
        project,
        lambda fraction, note="": printer(options.task, fraction, note),
    )
    table = write_result(options.out, result)
    keep(project, design, table)
    if options.json:
        say(json.dumps(table, allow_nan=False))
        return 0
    for row in table["rows"]:
        say(_line(row))
    say(f"open {options.out / REPORT}")
    return 0


def press_on_cluster(
    design: SensorDesign,
    plan: Plan,
    options: argparse.Namespace,
    project: Project,
    printer: Progress,
) -> None:
    """Make the presses of a task where `run_task` finds them; the rest of it runs here.

    Raises:
        LaneError: If the cluster has no worker, or loses its scheduler.
        WorkbenchError: As `make`.
    """
    from workbench.learning.making.collect import make
    from workbench.tasks.task import task_of

    recipe = task_of(plan.task).recipe(design, plan.size)
    folder = plan.data or options.out / "data"
    with open_cluster(options.cluster, project.store, printer) as cluster:
        make(recipe, folder, project, monitor=printer, cluster=cluster)


def _line(row: dict[str, Any]) -> str:
    """A row as people read it."""
    paper = "" if row["paper"] is None else f"  paper {row['paper']:.3g}"
    return (
        f"{row['test']:16} {row['metric']:18} {row['value']:8.3g} +- {row['spread']:<7.2g} "
        f"null {row['null']:.3g}{paper}"
    )


COMMAND = Command(place=5, run=run, options=options)
