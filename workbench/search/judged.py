"""What came of a trial: figures, or why there are none; what was computed and what was found."""

from __future__ import annotations

import enum
from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass, field
from typing import Any, Protocol

from workbench.core.base.monitor import Monitor
from workbench.search.problem import Value


class Status(enum.StrEnum):
    """How a trial ended."""

    JUDGED = "judged"
    """All figures of goals and limits are known."""
    REFUSED = "refused"
    """A cheap check, or a limit whose figure was known, said no before the rest was computed."""
    FAILED = "failed"
    """A stage did not get to its end."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Judged:
    """A trial that has ended."""

    status: Status
    figures: Mapping[str, float] = field(default_factory=dict[str, float])
    """Of all stages that ran."""
    reason: str = ""
    """Why not all of them did."""
    seconds: float = 0.0
    ran: Mapping[str, int] = field(default_factory=dict[str, int])
    """Stages that were computed."""
    found: Mapping[str, int] = field(default_factory=dict[str, int])
    """Stages whose results were stored already."""
    skipped: Mapping[str, int] = field(default_factory=dict[str, int])
    """Stages that a refusal spared."""
    keys: Mapping[str, str] = field(default_factory=dict[str, str])
    """Keys of results by stage."""
    parameters: Mapping[str, Value] = field(default_factory=dict[str, Value])
    """What was varied, linked and solved, as it is typed."""

    @property
    def table(self) -> dict[str, Any]:
        """As plain tables, for the journal."""
        return asdict(self) | {"status": self.status.value}


def from_journal(table: Mapping[str, Any]) -> Judged:
    """A trial as the journal has it."""
    return Judged(**{**table, "status": Status(table["status"])})


class Evaluator(Protocol):
    """Who judges the values that a search proposes."""

    @property
    def of_the_press(self) -> frozenset[str]:
        """Varied fields that a press depends on: trials that share them share it."""
        ...

    def judge(self, values: Mapping[str, Value], monitor: Monitor) -> Judged:
        """What comes of these values; never raises but for `Cancelled` and bugs."""
        ...

    def judge_base(self, monitor: Monitor) -> Judged:
        """What comes of the base, by the same settings."""
        ...


COUNTED = {"press": "presses", "bake": "bakes", "shoot": "images", "build": "bodies"}
"""Stages that people ask about, and what they call their results."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Savings:
    """How often stages were computed, found in the store, or spared by a refusal."""

    ran: Mapping[str, int]
    found: Mapping[str, int]
    skipped: Mapping[str, int]

    @property
    def words(self) -> str:
        """For people: `presses: 12 computed, 24 found, 6 spared` and so on."""
        parts = []
        for stage, name in COUNTED.items():
            counts = [each.get(stage, 0) for each in (self.ran, self.found, self.skipped)]
            if any(counts):
                kinds = zip(counts, ("computed", "found", "spared"), strict=True)
                parts.append(f"{name}: " + ", ".join(f"{count} {kind}" for count, kind in kinds))
        return "; ".join(parts)


def savings(trials: Iterable[Judged]) -> Savings:
    """What the cache and the cheap checks saved."""
    ran: Counter[str] = Counter()
    found: Counter[str] = Counter()
    skipped: Counter[str] = Counter()
    for trial in trials:
        ran.update(trial.ran)
        found.update(trial.found)
        skipped.update(trial.skipped)
    return Savings(ran=dict(ran), found=dict(found), skipped=dict(skipped))
