"""A search whose front is known, judged by closed forms: through the same loop as a real one.

With x the albedo and y the gloss of the coating, both in [0, 1], the losses are x^2 + (y - 1/2)^2
and (x - 1)^2 + (y - 1/2)^2. No point beats another on the line y = 1/2, so there
sqrt(f) + sqrt(g) = 1, and everywhere else it is more. Figures borrow names of the score card.
"""

from __future__ import annotations

import math
import sys
import time
from collections.abc import Mapping
from pathlib import Path

from workbench.core.base.monitor import Monitor
from workbench.project.project import Project
from workbench.search.judged import Judged, Status
from workbench.search.loop import Budget, search
from workbench.search.problem import Problem, Value
from workbench.search.problem_file import read_problem

X, Y = "design.optics.coating.albedo", "design.optics.coating.specular"
F, G, LIMITED = "membrane_g", "glare_percent", "skin_seen_percent"
TEXT = f"""
base = "geltip"
seed = 3
[[vary]]
field = "{X}"
low = 0.0
high = 1.0
[[vary]]
field = "optics.coating.specular"
low = 0.0
high = 1.0
[[goal]]
figure = "{F}"
want = "min"
[[goal]]
figure = "{G}"
want = "min"
"""
LIMIT = f"""
[[limit]]
figure = "{LIMITED}"
at_least = 30.0
"""


def toy_problem(folder: Path, more: str = "") -> Problem:
    return read_problem(TEXT + more, Project(folder / "project"), folder=folder)


class Toy:
    """Judges by the closed forms; what is beyond `refused_above` is refused."""

    def __init__(self, *, refused_above: float = 9.0, slow_s: float = 0.0) -> None:
        self.refused_above = refused_above
        self.slow_s = slow_s
        """Time that each design takes [s]; of one that takes any it is printed when it begins."""
        self.of_the_press: frozenset[str] = frozenset()
        self.asked: list[Mapping[str, Value]] = []

    def judge(self, values: Mapping[str, Value], monitor: Monitor) -> Judged:
        monitor(0.5, "toy")
        if self.slow_s:
            print("judging", flush=True)
            time.sleep(self.slow_s)
        self.asked.append(values)
        x, y = float(values[X]), float(values[Y])
        if x + y > self.refused_above:
            return Judged(status=Status.REFUSED, reason="beyond the line", parameters=values)
        figures = closed_forms(x, y)
        ran = {"press": 1} if self.of_the_press else {}
        return Judged(status=Status.JUDGED, figures=figures, parameters=values, ran=ran)

    def judge_base(self, monitor: Monitor) -> Judged:
        monitor(0.5, "toy")
        figures = closed_forms(1.0, 1.0)
        return Judged(status=Status.JUDGED, figures=figures, parameters={X: 1.0, Y: 1.0})


def closed_forms(x: float, y: float) -> dict[str, float]:
    return {F: x**2 + (y - 0.5) ** 2, G: (x - 1) ** 2 + (y - 0.5) ** 2, LIMITED: 100.0 * x}


def beyond(judged: Judged) -> float:
    """How far a trial is from the front, 0 on it."""
    return math.sqrt(judged.figures[F]) + math.sqrt(judged.figures[G]) - 1.0


if __name__ == "__main__":
    out, trials = Path(sys.argv[1]), int(sys.argv[2])
    search(
        toy_problem(out),
        Toy(slow_s=float(sys.argv[3])),
        out / "study.jsonl",
        Budget(trials=trials),
        on_trial=lambda told: print(told.number, flush=True),
    )
