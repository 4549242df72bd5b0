"""Write `scale.md`: what a million designs and the paper's samples cost, and what saturates first.

    python -m docs.generate_scale

prints it, from the records that `scale_plans.py` names.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from docs.scale_plans import (
    ASKER,
    ASSUMED,
    FEM,
    IMAGE,
    PRESS,
    Plan,
    fem_s,
    plans,
    processor,
    rate_s,
    recorded,
    values_of,
)
from workbench.cluster.cost import asked, most_per_s, saturations
from workbench.cluster.simulation import WORK, Spread, simulate
from workbench.learning.dataset.estimate import HOUR_S
from workbench.proof.benchmarks.records import RoomRecord, shipped_records

WORKERS = (1, 10, 100, 1000)
ROUNDS, LEAST = 20, 2000
"""Jobs of a simulation for each worker, and in all: the first and the last, when not all are under
way, hardly count then, nor does chance."""
HEAD = f"""# What much work costs

Made by `make docs` from the record of `workbench bench stages` in `docs/scale`, from other records
and from what is assumed. Measure your own machine by
`workbench bench stages --record docs/scale/stages.json`, and print this page anew by
`python -m docs.generate_scale`. Nobody has made a million designs: this is a plan.

Assumed, not measured:

{ASSUMED}"""
COST = """## What it costs

With presses on a GPU, core-hours are those of all else. Proposals and what else the one who asks
does are counted.
"""
FIRST = """## What saturates first

A station that serves one at a time is saturated by so many workers; more of them wait for it.
"""
LONG = """## How long it takes

With fixed times W workers end at most min(W / time of a job, 1 / time at the slowest station) jobs
a second, the bound of closed queueing networks. *Simulated* lets jobs go through the cluster event
by event, as many under way as there are workers: with the mean time of each step, and with times
that are exponentially distributed about it, which is more uneven than stages are. Near the number
of workers that saturates a station jobs wait for each other, and the bound is too good.
"""


def page() -> str:
    """The whole page."""
    record = recorded()
    known = plans(record)
    measured = f"Measured, in time of processors: {_title(record)}."
    return "\n".join(
        [
            *(HEAD, measured, "", *_measured(record), ""),
            *(COST, *_costs(known), ""),
            *(FIRST, *_saturations(known), ""),
            *(LONG, *_times(known), ""),
        ]
    )


def _title(record: RoomRecord) -> str:
    return f"{record.title}, **stale**" if record.kept.stale() else record.title


def _measured(record: RoomRecord) -> Iterator[str]:
    written, read = values_of(record, "stage_written"), values_of(record, "stage_read")
    yield "| measured | core-seconds | MB written | MB read |"
    yield "|---|---|---|---|"
    for case, seconds in values_of(record, "stage_cpu").items():
        yield f"| {case} | {seconds:.3g} | {written[case]:.3g} | {read[case]:.3g} |"
    words = {
        "judging_cpu": "left to the one who asks, {}",
        "proposal_cpu": "a proposal by {}",
        "task_cpu": "a task: {}",
    }
    for name, text in words.items():
        for case, seconds in values_of(record, name).items():
            yield f"| {text.format(case)} | {seconds:.3g} | | |"
    what = "a frame of the finger by finite elements, `fem_matrix.json`"
    what += ", **stale**" if FEM.stale() else ""
    yield f"| {what} | {fem_s():.3g} | | |"
    for row in (PRESS, IMAGE):
        yield f"| `{row}`, {_title(processor())} | {rate_s(row):.3g} | | |"


def _costs(known: Sequence[Plan]) -> Iterator[str]:
    rates = {_title(each): each.value(PRESS) for each in shipped_records() if each.kind == "cuda"}
    gpus = {title: rate for title, rate in rates.items() if rate}
    heads = "".join(f" core-hours with {name} | its hours |" for name in gpus)
    yield f"| what | tasks | TB written | core-hours |{heads}"
    yield "|---|---|---|---|" + "---|---|" * len(gpus)
    for plan in known:
        of_each = asked(plan.steps)
        work_s = of_each[WORK] + of_each.get(ASKER, 0.0)
        cells = [f"{plan.tasks * plan.jobs:,.0f}", f"{plan.written_MB * plan.jobs / 1e6:.3g}"]
        cells.append(_hours(work_s * plan.jobs))
        for rate in gpus.values():
            cells.append(_hours((work_s - plan.press_s) * plan.jobs))
            cells.append(_hours(plan.presses * plan.jobs / rate))
        yield f"| {plan.what} | {' | '.join(cells)} |"


def _saturations(known: Sequence[Plan]) -> Iterator[str]:
    yield "| what | station | seconds of a job | workers |"
    yield "|---|---|---|---|"
    for plan in known:
        for each in saturations(plan.steps):
            cells = f"{each.station} | {each.seconds:.2g} | {each.workers:,.0f}"
            yield f"| {plan.what} | {cells} |"


def _times(known: Sequence[Plan]) -> Iterator[str]:
    yield "| what | workers | hours by the bound | simulated, fixed | simulated, uneven |"
    yield "|---|---|---|---|---|"
    for plan in known:
        for workers in WORKERS:
            rates = [most_per_s(plan.steps, workers)]
            for spread in Spread:
                jobs = max(ROUNDS * workers, LEAST)
                rates.append(simulate(plan.steps, workers=workers, jobs=jobs, spread=spread).per_s)
            cells = " | ".join(_hours(plan.jobs / per_s) for per_s in rates)
            yield f"| {plan.what} | {workers:,} | {cells} |"


def _hours(seconds: float) -> str:
    hours = seconds / HOUR_S
    return f"{hours:,.0f}" if hours >= 100.0 else f"{hours:.3g}"


if __name__ == "__main__":
    print(page())
