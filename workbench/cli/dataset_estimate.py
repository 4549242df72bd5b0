"""What a data set costs before it is made: by what is finished of it, else by a few cases timed."""

from __future__ import annotations

import argparse
import dataclasses
import json
import tempfile
from pathlib import Path
from typing import Any

from workbench.core.base.errors import DesignError
from workbench.learning.dataset.recipe import Recipe
from workbench.project.project import Project
from workbench.system.terminal import Progress, say


def say_estimate(recipe: Recipe, options: argparse.Namespace, project: Project) -> int:
    """What there is to do, and what it costs by the cases that are finished, or by a pilot."""
    from workbench.learning.dataset.cases import deal, positions_of
    from workbench.learning.dataset.estimate import estimate, estimate_text
    from workbench.learning.dataset.folder import FAILED, MANIFEST, TIMES, DataSet
    from workbench.learning.dataset.json_lines import read_rows
    from workbench.learning.dataset.positions import Pattern, Position

    if recipe.pattern is Pattern.SPREAD:
        # Where they lie does not matter here, and would need the mesh.
        places = [
            Position(name=f"point{k:03d}", target_mm=(0.0, 0.0, 0.0)) for k in range(recipe.points)
        ]
    else:
        places = positions_of(recipe)
    cases = deal(recipe, places)
    done, times = 0, []
    if (options.out / MANIFEST).exists():
        data = DataSet.open(options.out)
        if data.key != recipe.key:
            raise DesignError(
                f"{options.out} holds a data set of another recipe",
                hint="give the options that it was begun with",
                at="--out",
            )
        failed = {row["id"] for row in read_rows(options.out / FAILED)}
        done = sum(len(data.frames(case)) for case in cases)
        done += sum(case.frames - len(data.frames(case)) for case in cases if case.id in failed)
        times = read_rows(options.out / TIMES)
    if not times:
        times = pilot(recipe, project, batch=options.batch, as_json=options.json)
    samples = sum(case.frames for case in cases)
    found = {
        "cases": len(cases),
        "samples": samples,
        "samples_distinct": sum(case.frames - case.first_new for case in cases),
        **estimate(times, samples - done, jobs=options.jobs),
    }
    if options.json:
        say(json.dumps(found))
    else:
        say(
            f"{found['cases']:,} cases, {found['samples']:,} samples "
            f"({found['samples_distinct']:,} distinct states)"
        )
        say(estimate_text(found))
    return 0


def pilot(recipe: Recipe, project: Project, *, batch: int, as_json: bool) -> list[dict[str, Any]]:
    """Times of a few cases, made and thrown away; the first batch warms up and does not count.

    Raises:
        WorkbenchError: As `make` does; what it prepares stays in the project's store.
    """
    from workbench.learning.dataset.folder import TIMES
    from workbench.learning.dataset.json_lines import read_rows
    from workbench.learning.making.collect import make, side_by_side

    size = batch or side_by_side()
    few = dataclasses.replace(recipe, cases=2 * size)
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder) / "pilot"
        make(few, place, project, batch=size, monitor=Progress(as_json=as_json))
        rows = read_rows(place / TIMES)
    return rows[size:] or rows
