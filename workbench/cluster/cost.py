"""What much work costs on a cluster, and what saturates first, in closed form.

With D the time that a job asks of each station, and Z the time that it asks of a worker, W workers
end at most min(W / (Z + sum D), 1 / max D) jobs a second: each worker does one job after the other,
and the slowest station serves one at a time. Where the two are equal the station is saturated.
Source: P. J. Denning and J. P. Buzen, The Operational Analysis of Queueing Network Models, ACM
Computing Surveys 10 (1978), asymptotic bounds.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass

from workbench.cluster.simulation import WORK, Step


@dataclass(frozen=True, kw_only=True, slots=True)
class Saturated:
    """The station that is the first to hold all others up."""

    station: str
    seconds: float
    """What a job asks of it [s]."""
    workers: float
    """So many keep it busy; more are idle."""


def asked(steps: Sequence[Step]) -> dict[str, float]:
    """What a job asks of workers and of each station in all [s]."""
    found: defaultdict[str, float] = defaultdict(float)
    for step in steps:
        found[step.station] += step.seconds
    return dict(found)


def saturations(steps: Sequence[Step]) -> list[Saturated]:
    """The stations, that which is saturated first at the front."""
    of_each = asked(steps)
    whole = sum(of_each.values())
    found = [
        Saturated(station=name, seconds=seconds, workers=whole / seconds)
        for name, seconds in of_each.items()
        if name != WORK and seconds > 0.0
    ]
    return sorted(found, key=lambda each: each.workers)


def most_per_s(steps: Sequence[Step], workers: int) -> float:
    """Jobs that so many workers end at most [1/s]."""
    alone = workers / sum(asked(steps).values())
    return min([alone, *(1.0 / each.seconds for each in saturations(steps))])
