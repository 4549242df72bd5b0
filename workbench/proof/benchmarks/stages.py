"""What each step of much work asks of a processor and a disk: figures for plans (`docs/scale.md`).

A design is judged as a search judges it, with a press of its own and all checks left out; then once
more with other light on the same press. Kernels are compiled on a design before, which is not
counted. Times are those of processors, children included, so that what else runs on the machine
matters little; a worker with one thread takes as long where it has a core.
"""

from __future__ import annotations

import os
import tempfile
import time
from collections import defaultdict
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from workbench.core.base.errors import DesignError
from workbench.core.base.monitor import Monitor, silent
from workbench.pipeline.devices import open_device
from workbench.pipeline.stage import Call, Outcome
from workbench.pipeline.store import Store
from workbench.planning.plan import InlineRunner
from workbench.project.project import Project
from workbench.proof.row import Row, stated
from workbench.search.evaluator import DesignEvaluator
from workbench.search.judged import Judged, Status
from workbench.search.problem import Problem, Value
from workbench.search.problem_file import read_problem

GOALS = ("light_evenness_p5_over_p95_1", "normal_force_N")
"""Evenness needs the maps, the force a press."""
LENGTH, TILT = "design.shape.cylinder_mm", "design.optics.ring.tilt_deg"
PROBLEM = f"""
base = "geltip"
seed = 1
[[vary]]
field = "{LENGTH}"
low = 18.0
high = 24.0
[[vary]]
field = "{TILT}"
low = -20.0
high = 20.0
[[goal]]
figure = "{GOALS[0]}"
want = "max"
[[goal]]
figure = "{GOALS[1]}"
want = "max"
"""
"""Shape and light vary."""
WARM = {LENGTH: 20.0, TILT: 0.0}
PRESSED = {LENGTH: 21.0, TILT: 0.0}
LIT = {LENGTH: 21.0, TILT: 10.0}
"""What compiles, what presses anew, and what only lights anew."""
TASKS = 2000
"""Tasks that do nothing, of which the share of the one who asks is measured."""
TRIALS = 40
"""Of the search whose proposals are timed; the last eight count."""
MB = 1e6


def rows() -> list[Row]:
    """All rows of the room."""
    open_device()
    return [*design_rows(), *proposal_rows(), task_row()]


def cpu_s() -> float:
    """Processor time of this process and of its children that have ended [s]."""
    spent = os.times()
    return spent.user + spent.system + spent.children_user + spent.children_system


@dataclass(kw_only=True, slots=True)
class Ledger:
    """Runs calls here, and keeps what each stage took, wrote and read."""

    store: Store
    cpu_s: defaultdict[str, float] = field(default_factory=lambda: defaultdict(float))
    written_MB: defaultdict[str, float] = field(default_factory=lambda: defaultdict(float))
    read_MB: defaultdict[str, float] = field(default_factory=lambda: defaultdict(float))

    def run(self, call: Call, monitor: Monitor) -> Outcome:
        """Compute the call unless it is stored."""
        begun = cpu_s()
        outcome = InlineRunner(self.store).run(call, monitor)
        if not outcome.cached:
            self.cpu_s[call.stage] += cpu_s() - begun
            self.written_MB[call.stage] += self.store.entry(call.stage, call.key).bytes / MB
            reads = (self.store.entry(ref.stage, ref.key).bytes for ref in call.reads)
            self.read_MB[call.stage] += sum(reads) / MB
        return outcome


def design_rows() -> Iterator[Row]:
    """Stages of a design with a press of its own, and of another light on that press."""
    with tempfile.TemporaryDirectory() as folder:
        project = Project(folder)
        problem = read_problem(PROBLEM, project, folder=Path(folder))
        judged_alone(problem, project, WARM)
        for what, values in (("a press of its own", PRESSED), ("on that press", LIT)):
            ledger, asker_s = judged_alone(problem, project, values)
            for stage, seconds in ledger.cpu_s.items():
                case = f"{stage}, {what}"
                yield stated("stage_cpu", case, seconds, unit="s")
                yield stated("stage_written", case, ledger.written_MB[stage], unit="MB")
                yield stated("stage_read", case, ledger.read_MB[stage], unit="MB")
            yield stated("judging_cpu", what, asker_s, unit="s")
        yield stated("frames", "press", problem.base.case.press.frames, unit="1")


def judged_alone(
    problem: Problem, project: Project, values: Mapping[str, Value]
) -> tuple[Ledger, float]:
    """What the stages of a design took, and what was left to the one who asked for them [s].

    Raises:
        DesignError: If the design was refused: then not all stages ran.
    """
    ledger, begun = Ledger(store=project.store), cpu_s()
    found = DesignEvaluator(problem, project, runner=ledger).judge(values, silent)
    if found.status is not Status.JUDGED:
        raise DesignError(f"the design was {found.status.value}: {found.reason}", at="bench")
    return ledger, cpu_s() - begun - sum(ledger.cpu_s.values())


class _AtOnce:
    """Judges by closed forms, so that a search's own time is all there is."""

    of_the_press: frozenset[str] = frozenset()

    def judge(self, values: Mapping[str, Value], monitor: Monitor) -> Judged:
        x, y = float(values[LENGTH]), float(values[TILT])
        figures = {
            "light_evenness_p5_over_p95_1": x - y**2 / 100.0,
            "normal_force_N": y - x**2 / 100.0,
        }
        return Judged(status=Status.JUDGED, figures=figures, parameters=dict(values))

    def judge_base(self, monitor: Monitor) -> Judged:
        return self.judge(WARM, monitor)


def proposal_rows() -> Iterator[Row]:
    """What a search itself spends on a trial, by who proposed it, once there are some."""
    from workbench.search.loop import Budget, Told, search

    spent: dict[str, list[float]] = {}
    last = cpu_s()

    def heard(told: Told) -> None:
        nonlocal last
        now = cpu_s()
        if told.counted > TRIALS - 8:
            spent.setdefault(told.sampler, []).append(now - last)
        last = now

    with tempfile.TemporaryDirectory() as folder:
        project = Project(folder)
        problem = read_problem(PROBLEM, project, folder=Path(folder))
        journal = Path(folder) / "study.jsonl"
        search(problem, _AtOnce(), journal, Budget(trials=TRIALS), on_trial=heard)
    for name, times in spent.items():
        case = f"{name}, after {TRIALS - 8} trials"
        yield stated("proposal_cpu", case, sum(times) / len(times), unit="s")


def nothing(number: int) -> int:
    """A task that costs nothing but itself."""
    return number


def task_row() -> Row:
    """What a task of Dask costs the process that has both client and scheduler."""
    case = f"Dask's client and scheduler, {TASKS} tasks that do nothing"
    return stated("task_cpu", case, _task_cpu_s, unit="s")


def _task_cpu_s() -> float:
    from workbench.cluster.opening import opened
    from workbench.cluster.where import Where

    with tempfile.TemporaryDirectory() as folder:
        with opened(Where(kind="local", workers=1), Store(folder)) as cluster:
            return _own_s(lambda count: _all_done(cluster.client, count)) / TASKS


def _all_done(client: Any, count: int) -> None:
    client.gather(client.map(nothing, range(count), pure=False))


def _own_s(work: Callable[[int], None]) -> float:
    """Processor time of this process alone, after a tenth of the work that does not count [s]."""
    work(TASKS // 10)
    begun = time.process_time()
    work(TASKS)
    return time.process_time() - begun
