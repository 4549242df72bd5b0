"""A cluster on paper: many workers, and what serves them one at a time, event by event.

A job is a row of steps. Most are work, which each worker does by itself; the others are at stations
that all share (the scheduler, the disk) and that serve in the order of arrival. So many jobs are
under way as there are workers, as `spread` keeps it: one that ends lets the next begin. That is a
closed queueing network with a delay, whose bounds `cost.py` has in closed form.
"""

from __future__ import annotations

import enum
import heapq
import random
from collections import defaultdict
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

WORK = "workers"
"""The step that needs no station."""


class Spread(enum.StrEnum):
    """How the times of one step differ from job to job."""

    NONE = "none"
    EXPONENTIAL = "exponential"
    """Of the step's mean; their deviation is as large as it, which is more than stages show."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Step:
    """One step of a job."""

    station: str
    """`WORK`, or who serves it."""
    seconds: float
    """Mean time of service [s]."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Simulated:
    """What a simulation gave."""

    per_s: float
    """Jobs that ended over the time until the last one did [1/s]."""
    busy: Mapping[str, float]
    """Share of that time in which each station served, of `WORK` in which a mean worker worked."""


def simulate(
    steps: Sequence[Step],
    *,
    workers: int,
    jobs: int,
    spread: Spread = Spread.NONE,
    seed: int = 1,
) -> Simulated:
    """Let jobs go through a cluster.

    Args:
        steps: Of each job, in order.
        workers: How many jobs are under way at once, at least 1.
        jobs: How many in all, at least 1.
        spread: How times differ.
        seed: Of what is drawn.
    """
    drawn = _drawing(spread, seed)
    free: defaultdict[str, float] = defaultdict(float)
    served: defaultdict[str, float] = defaultdict(float)
    # When a job arrives at a step; taken in the order of time, so a station serves who came first.
    arriving = [(0.0, number, 0) for number in range(min(workers, jobs))]
    begun = len(arriving)
    last = 0.0
    while arriving:
        now, number, place = heapq.heappop(arriving)
        if place == len(steps):
            last = now
            if begun < jobs:
                heapq.heappush(arriving, (now, begun, 0))
                begun += 1
            continue
        step, seconds = steps[place], drawn(steps[place].seconds)
        start = now if step.station == WORK else max(now, free[step.station])
        free[step.station] = start + seconds
        served[step.station] += seconds
        heapq.heappush(arriving, (start + seconds, number, place + 1))
    served[WORK] /= workers
    return Simulated(per_s=jobs / last, busy={name: time / last for name, time in served.items()})


def _drawing(spread: Spread, seed: int) -> Callable[[float], float]:
    if spread is Spread.NONE:
        return lambda mean: mean
    chance = random.Random(seed)
    return lambda mean: mean * chance.expovariate(1.0)
