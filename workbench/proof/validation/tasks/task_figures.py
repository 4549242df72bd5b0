"""Makes the records of tasks.

`python -m workbench.proof.validation.tasks.task_figures FOLDER [SIZE [DESIGN_TASK]]` runs the tasks
that are on record, one or all, in folders of FOLDER; what lies there already is kept. Small ones
take minutes each on a free processor; `paper` is for a GPU. Those of the paper also photograph a
twin: its 140 photographs of the paper's size are of 57 paths by finite elements, each of half a
minute of a processor on the finger, and of two on the pad.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from workbench.core.base.errors import DesignError, shown
from workbench.core.base.mapping import suggest
from workbench.project.named_designs import load_design
from workbench.project.project import Project
from workbench.proof.validation.tasks.task_records import SIZES, TaskRecord, task_records
from workbench.system.processes import cores
from workbench.system.terminal import Progress
from workbench.tasks.features import usual_network
from workbench.tasks.result_file import write_result
from workbench.tasks.run import Plan, run_task
from workbench.tasks.task import Size, task_of


def figures(one: TaskRecord, folder: Path) -> dict[str, Any]:
    """What `result.json` of a task holds."""
    size = Size(one.size)
    plan = Plan(
        task=one.task,
        size=size,
        net=usual_network(task_of(one.task)),
        jobs=cores(),
        twin=one.twin,
    )
    out, printer = folder / one.name, Progress(as_json=False)
    result = run_task(
        load_design(one.design),
        plan,
        out,
        Project(folder / "project"),
        lambda fraction, note="": printer(one.name, fraction, note),
    )
    return {"result": write_result(out, result)}


def wanted(words: Sequence[str]) -> list[TaskRecord]:
    """The records that a command line asks for.

    Raises:
        DesignError: If there is none of that name.
    """
    size = words[0] if words else SIZES[0]
    found = [
        one
        for one in task_records()
        if one.size == size and (len(words) < 2 or one.name == f"{words[1]}_{size}")
    ]
    if not found:
        known = [one.name for one in task_records()]
        name = "_".join([*words[1:2], size])
        raise DesignError(f"no task {shown(name)} is on record", hint=suggest(name, known))
    return found


def main(words: Sequence[str]) -> int:
    """Make the records."""
    for one in wanted(words[1:]):
        one.record.make(lambda one=one: figures(one, Path(words[0])))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
