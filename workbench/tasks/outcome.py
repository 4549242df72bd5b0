"""What a task's tests say: rows, what stands behind them, and examples that went wrong."""

from __future__ import annotations

import enum
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from workbench.tasks.examples import Examples
from workbench.tasks.scores import confusion, rank_correlation, scored
from workbench.tasks.task import Look, Task, Told
from workbench.tasks.trained import Trained

MOST_SHOWN = 8
"""Examples that went wrong in a gallery."""


class Trial(enum.StrEnum):
    """What is tested, all of them by networks that learned from renders."""

    SIM = "sim"
    """Renders, split at random as in the paper: depths of one press are on both sides."""
    PLACE = "sim_by_place"
    """Renders at places that training did not show."""
    TWIN = "twin"
    """Photographs of a twin; trained on the nominal design."""
    CALIBRATED = "twin_calibrated"
    """The same photographs; trained on the design calibrated to its twin."""
    PHOTOS = "photos"
    """Photographs of the user's; trained on the nominal design."""


RENDERS = (Trial.SIM, Trial.PLACE)
WORDS = {
    Trial.SIM: "renders, split at random",
    Trial.PLACE: "renders at places that training did not show",
    Trial.TWIN: "photographs of a twin, trained on renders of the design",
    Trial.CALIBRATED: "the same photographs, the design calibrated to some of a ball",
    Trial.PHOTOS: "own photographs, trained on renders of the design",
}


@dataclass(frozen=True, kw_only=True, slots=True)
class Row:
    """One score beside that of the trivial method, and of the paper where it has one."""

    task: str
    test: str
    metric: str
    value: float
    """Mean over the seeds."""
    spread: float
    """Standard deviation over the seeds."""
    null: float
    """Mean over the seeds of the score of the trivial method."""
    paper: float | None


@dataclass(frozen=True, kw_only=True, slots=True)
class Run:
    """One network on one test."""

    seed: int
    trained: Trained
    learned_from: int
    """Examples that it learned from."""
    test: Examples
    told: np.ndarray
    null: np.ndarray
    seconds: float


@dataclass(frozen=True, kw_only=True, slots=True)
class Failure:
    """An example that a network told wrongly."""

    name: str
    seen: np.ndarray
    """What it was shown of the last image [grey level], shape (h, w, 3), int16."""
    words: str


@dataclass(frozen=True, kw_only=True, slots=True)
class Tested:
    """One test of a task."""

    test: Trial
    rows: list[Row]
    details: dict[str, Any]
    failures: list[Failure] = field(default_factory=list[Failure])


def tested(name: str, task: Task, test: Trial, runs: Sequence[Run]) -> Tested:
    """What the runs of all seeds say together."""
    scores = [scored(task, run.told, run.test, run.null) for run in runs]
    rows = []
    for k, first in enumerate(scores[0]):
        values = np.array([score[k].value for score in scores])
        rows.append(
            Row(
                task=name,
                test=test.value,
                metric=first.metric,
                value=float(values.mean()),
                spread=float(values.std(ddof=1)) if len(values) > 1 else 0.0,
                null=float(np.mean([score[k].null for score in scores])),
                paper=_published(task, test, first.metric),
            )
        )
    details: dict[str, Any] = {
        "learned_from": [run.learned_from for run in runs],
        "tested_on": [len(run.test) for run in runs],
        "outputs": list(runs[0].test.outputs),
        "null": task.null.value,
        "seeds": [
            {
                "seed": run.seed,
                "values": {each.metric: each.value for each in score},
                "null": {each.metric: each.null for each in score},
                "best_step": run.trained.epoch,
                "curve": run.trained.curve,
                "seconds": round(run.seconds, 1),
            }
            for run, score in zip(runs, scores, strict=True)
        ],
        **(_of_classes(runs) if task.told is Told.CLASS else _of_values(runs)),
    }
    return Tested(test=test, rows=rows, details=details, failures=_failures(task, runs[0]))


def _published(task: Task, test: Trial, metric: str) -> float | None:
    """The paper's split is at random; its photographs stand beside a twin's and the user's."""
    for each in task.published:
        if each.metric == metric and test is not Trial.PLACE:
            return each.sim if test is Trial.SIM else each.real
    return None


def _of_classes(runs: Sequence[Run]) -> dict[str, Any]:
    classes = len(runs[0].test.outputs)
    table = sum(
        (confusion(run.told, run.test.truth, classes) for run in runs),
        np.zeros((classes, classes), np.int64),
    )
    often = table.sum(axis=1)
    recall = {
        name: float(table[k, k] / often[k]) if often[k] else None
        for k, name in enumerate(runs[0].test.outputs)
    }
    return {"confusion": table.tolist(), "recall": recall}


def _of_values(runs: Sequence[Run]) -> dict[str, Any]:
    """Rank correlation of told and true values, mean over the seeds."""
    return {
        "rank_correlation": {
            name: float(
                np.mean([rank_correlation(run.told[:, k], run.test.truth[:, k]) for run in runs])
            )
            for k, name in enumerate(runs[0].test.outputs)
        }
    }


def _failures(task: Task, run: Run) -> list[Failure]:
    """The worst of the first seed."""
    test, outputs = run.test, run.test.outputs
    if task.told is Told.CLASS:
        wrong = np.flatnonzero(run.told != test.truth)[:MOST_SHOWN]
        words = [
            f"{outputs[test.truth[k]]}, told as {outputs[run.told[k]]}" for k in wrong.tolist()
        ]
    else:
        off = np.abs(run.told[:, 0] - test.truth[:, 0])
        wrong = np.argsort(-off)[:MOST_SHOWN]
        words = [
            f"{outputs[0]} {test.truth[k, 0]:.3g}, told as {run.told[k, 0]:.3g}"
            for k in wrong.tolist()
        ]
    last = -1 if task.look is Look.WINDOW else 0
    return [
        Failure(name=test.names[k], seen=test.inputs[k, last], words=text)
        for k, text in zip(wrong.tolist(), words, strict=True)
    ]
