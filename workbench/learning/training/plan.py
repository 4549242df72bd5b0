"""What a training is asked for, and what it says while it runs and when it ends."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from sim.forces.network.spec import Target
from sim.forces.network.weights import NetworkWeights
from sim.forces.training.settings import Numbers, TrainingSettings
from workbench.core.base.digest import digest
from workbench.core.base.errors import DesignError
from workbench.learning.dataset.cases import Split
from workbench.learning.training.presses import Presses

VERSION = 3
"""Raised whenever the same plan and data give other weights."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Plan:
    """What is trained how; the data are apart."""

    settings: TrainingSettings
    target: Target
    seed: int = 0
    cases: int = 0
    """The first so many training cases; 0: all."""
    base: NetworkWeights | None = None
    """Weights whose decoder is trained further; None: a new network."""
    base_name: str = ""
    """Of their file, which names their content."""

    def key(self, presses: Presses) -> str:
        """Digest of all that the weights depend on: what a checkpoint must agree in."""
        return digest(
            {
                "version": VERSION,
                "settings": self.settings,
                "target": self.target,
                "seed": self.seed,
                "cases": self.cases,
                "base": self.base_name,
                "data": presses.key,
            }
        )

    def states(self, presses: Presses) -> list[int]:
        """Numbers of the samples to train on: all, or those of the first cases of the split.

        Raises:
            DesignError: If there are none, or fewer cases than asked for.
        """
        there = presses.cases(Split.TRAIN)
        if not there or self.cases > len(there):
            asked = f", {self.cases} are asked for" if self.cases else ""
            raise DesignError(
                f"the data have {len(there)} cases to train on{asked}",
                hint="make more cases with workbench dataset make --cases N",
                at="data",
            )
        return presses.of_split(Split.TRAIN, cases=there[: self.cases] if self.cases else None)


@dataclass(frozen=True, kw_only=True, slots=True)
class Resources:
    """What a training may use; the plan is the same with others."""

    device: str
    """`cpu` or `cuda`."""
    numbers: Numbers = Numbers.AUTO
    """Type of the arithmetic."""
    minutes: float = 0.0
    """Time after which it pauses at the end of an epoch [min]; 0: none."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Course:
    """How a training has gone."""

    rows: Sequence[dict[str, Any]]
    """Of the curves, one for each epoch."""
    best_epoch: int
    seconds: float
    """That its epochs took [s]."""
    finished: bool


@dataclass(frozen=True, kw_only=True, slots=True)
class TrainingProgress:
    """How far a training is, after an epoch."""

    row: dict[str, Any]
    """Of the curves."""
    epochs: int
    """That are planned."""
    eta_s: float
    """Time that remains at the pace so far [s], if it does not stop early."""
    notes: list[str]
    """All so far."""


Tell = Callable[[TrainingProgress], None]


@dataclass(frozen=True, kw_only=True, slots=True)
class Trained:
    """A training that ended or paused."""

    weights: Path
    rows: tuple[dict[str, Any], ...]
    best_epoch: int
    finished: bool
    scores: dict[str, Any]
    """By split, see `results.score`."""
    notes: tuple[str, ...] = ()
