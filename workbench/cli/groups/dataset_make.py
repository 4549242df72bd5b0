"""`workbench dataset make`: make a data set, or the rest of one."""

from __future__ import annotations

import argparse
import dataclasses
import json
import time
from pathlib import Path
from typing import Any

from workbench.cli.cluster_option import add_cluster_option, open_cluster
from workbench.cli.command import Command
from workbench.cli.dataset_estimate import say_estimate
from workbench.cli.press_arguments import add_set_option
from workbench.cli.press_options import typed_numbers
from workbench.cli.sample_line import SampleLine
from workbench.core.base.check import within
from workbench.core.base.errors import DesignError
from workbench.core.base.units import human_seconds
from workbench.core.press.fem import DRAFT_MM
from workbench.edit.typed_fields import with_typed
from workbench.learning.dataset.recipe import Recipe, Solvers
from workbench.learning.dataset.recipes import load_recipe
from workbench.project.project import Project
from workbench.system.terminal import Progress, say


def options(sub: argparse.ArgumentParser) -> None:
    """What may be typed behind it."""
    sub.add_argument("--json", action="store_true", help="answer as JSON")
    sub.add_argument("recipe", metavar="NAME|FILE", help="see `workbench dataset recipes`")
    text = "where the data set is, or will be"
    sub.add_argument("--out", required=True, type=Path, metavar="DIR", help=text)
    sub.add_argument("--cases", type=int, metavar="N", help="the first N cases; 0: all")
    sub.add_argument("--jobs", type=int, default=1, metavar="N", help="processes (default 1)")
    text = "presses side by side (default: 1, on each GPU 128)"
    sub.add_argument("--batch", type=int, default=0, metavar="N", help=text)
    text = f"hexahedra of {DRAFT_MM} mm: forces within 5 %%, three times faster"
    sub.add_argument("--draft", action="store_true", help=text)
    text = "another Young's modulus than the recipe's; cases and split stay the same"
    sub.add_argument("--young", type=float, metavar="MPA", help=text)
    solvers = [solver.value for solver in Solvers]
    text = "contact solver, finite elements, or both (default: the recipe's)"
    sub.add_argument("--solver", choices=solvers, help=text)
    sub.add_argument("--no-images", action="store_true", help="fields and forces only")
    add_cluster_option(sub)
    add_set_option(sub)
    text = "turn every object about the fixed X, then Y, then Z before it is pressed"
    sub.add_argument("--turn-deg", metavar="X,Y,Z", help=text)
    sub.add_argument("--seed", type=int, metavar="S", help="of the order of cases and the split")
    text = "only say what there is to do and what it costs, by the cases finished in DIR, else by \
two that are timed and thrown away"
    sub.add_argument("--estimate", action="store_true", help=text)


def chosen_recipe(options: argparse.Namespace, project: Project) -> Recipe:
    """The recipe with the options of the command line in it.

    Raises:
        DesignError: If there is none of that name, or a value is refused.
    """
    changes: dict[str, Any] = {
        "cases": options.cases,
        "seed": options.seed,
        "solvers": options.solver and Solvers(options.solver),
        "hex_mm": DRAFT_MM if options.draft else None,
        "images": False if options.no_images else None,
    }
    if options.turn_deg is not None:
        changes["turn_deg"] = typed_numbers(options.turn_deg, at="--turn-deg")
    given = {name: value for name, value in changes.items() if value is not None}
    recipe = dataclasses.replace(load_recipe(options.recipe, project), **given)
    if options.young is not None:
        design = recipe.design.replace("material.young_MPa", options.young)
        recipe = dataclasses.replace(recipe, design=design)
    return dataclasses.replace(recipe, design=with_typed(recipe.design, options.set))


def run(options: argparse.Namespace, project: Project) -> int:
    """Make a data set, or the rest of one that was stopped."""
    if options.jobs < 1:
        raise DesignError(
            f"{options.jobs} processes make nothing", hint="use --jobs 1 or more", at="--jobs"
        )
    within(options.batch, 0, 4096, what="presses side by side", unit="", at="--batch")
    recipe = chosen_recipe(options, project)
    if options.estimate:
        return say_estimate(recipe, options, project)
    from workbench.learning.making.collect import make as make_it

    printer = Progress(as_json=options.json)
    line = SampleLine(as_json=options.json)
    started = time.monotonic()
    try:
        with open_cluster(options.cluster, project.store, printer) as cluster:
            data = make_it(
                recipe,
                options.out,
                project,
                jobs=options.jobs,
                batch=options.batch,
                tell=line.tell,
                monitor=printer,
                cluster=cluster,
            )
    finally:
        line.end()
    counts = data.counts()
    if options.json:
        say(json.dumps({"folder": str(options.out), "key": data.key, **counts}))
    else:
        say(
            f"{counts['samples_done']} of {counts['samples']} samples, "
            f"{counts['cases_done']} of {counts['cases']} cases complete, "
            f"{counts['cases_failed']} failed, after {human_seconds(time.monotonic() - started)}; "
            f"open {options.out / 'card.md'}"
        )
    return 0 if counts["cases_done"] == counts["cases"] else 3


COMMAND = Command(place=1, run=run, options=options)
