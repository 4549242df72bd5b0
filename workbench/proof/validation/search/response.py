"""400 designs of a problem, each evaluated once as a trial of `workbench search` is.

    python -m workbench.proof.validation.search.response FOLDER light|mixed --jobs N

adds lines to `FOLDER/light.jsonl`, the base first. It goes on where it was after any end. A design
takes 6 to 15 s of a processor, so a problem an hour or two of one; results that trials share lie in
`FOLDER/project`, some 8 GB, and may be removed after it.
"""

from __future__ import annotations

import argparse
import multiprocessing
import sys
import time
from collections import defaultdict
from collections.abc import Sequence
from pathlib import Path

from workbench.project.project import Project
from workbench.proof.validation.search.problems import TEXTS, problem_of
from workbench.proof.validation.search.samples import (
    BASE,
    Sample,
    mend,
    read_samples,
    sobol_values,
    write_sample,
)
from workbench.search.evaluator import DesignEvaluator
from workbench.search.journal import problem_digest
from workbench.search.judged import Evaluator
from workbench.search.problem import Problem
from workbench.system.processes import follow_parent
from workbench.system.terminal import complain

COUNT = 400
"""Designs of each problem beside the base."""


class StageClock:
    """A monitor that adds up how long each stage takes, by the first word of its notes."""

    def __init__(self) -> None:
        self.stage_s: defaultdict[str, float] = defaultdict(float)
        self._stage, self._since = "", time.monotonic()

    def __call__(self, fraction: float, note: str = "") -> None:
        """Take in that a stage goes on, or that another one has begun."""
        now = time.monotonic()
        if self._stage:
            self.stage_s[self._stage] += now - self._since
        self._stage, self._since = note.partition(" ")[0] or self._stage, now


def evaluate_designs(
    problem: Problem, evaluator: Evaluator, path: Path, numbers: Sequence[int]
) -> None:
    """Evaluate designs that are not in the file yet, and add each as it ends.

    Args:
        problem: What varies.
        evaluator: Who judges: of the product, the one of a search.
        path: The file of lines.
        numbers: Of the designs in Sobol's sequence; `BASE` is the base.

    Raises:
        DesignError: If the file is of another problem.
    """
    of = problem_digest(problem)
    done = read_samples(path, of)
    designs = sobol_values(problem.vary, COUNT)
    for number in numbers:
        if number in done:
            continue
        clock = StageClock()
        values = {} if number == BASE else designs[number]
        judged = evaluator.judge_base(clock) if number == BASE else evaluator.judge(values, clock)
        clock(1.0)
        sample = Sample(number=number, values=values, judged=judged, stage_s=clock.stage_s)
        write_sample(path, sample, of)
        complain(f"{path.stem} {number}: {judged.status} in {judged.seconds:.1f} s {judged.reason}")


def work(folder: Path, name: str, numbers: Sequence[int]) -> None:
    """What one process does; its own end comes with that of the one that started it."""
    from workbench.pipeline.devices import open_device

    follow_parent()
    open_device()
    project = Project(folder / "project")
    problem = problem_of(name, project)
    evaluate_designs(problem, DesignEvaluator(problem, project), folder / f"{name}.jsonl", numbers)


def main(words: Sequence[str]) -> int:
    """Evaluate the designs of a problem that are missing."""
    parser = argparse.ArgumentParser(description="400 designs of a problem, evaluated once")
    parser.add_argument("folder", type=Path)
    parser.add_argument("problem", choices=list(TEXTS))
    parser.add_argument("--jobs", type=int, default=1, help="processes")
    options = parser.parse_args(words)
    options.folder.mkdir(parents=True, exist_ok=True)
    mend(options.folder / f"{options.problem}.jsonl")
    numbers = [BASE, *range(COUNT)]
    context = multiprocessing.get_context("spawn")
    processes = [
        context.Process(
            target=work,
            args=(options.folder, options.problem, numbers[part :: options.jobs]),
            daemon=True,
        )
        for part in range(options.jobs)
    ]
    for process in processes:
        process.start()
    for process in processes:
        process.join()
    return int(any(process.exitcode for process in processes))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
