"""Scores of what is told beside the truth, and what a trivial method would have scored."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from workbench.tasks.examples import Examples
from workbench.tasks.task import Look, Null, Task, Told

SAFETY = "safety"
"""Name of the coefficient among outputs."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Scored:
    """One metric of one training."""

    metric: str
    value: float
    null: float


def scored(task: Task, told: np.ndarray, test: Examples, null: np.ndarray) -> list[Scored]:
    """Scores of one training, its first metric first.

    Args:
        task: Says what is told.
        told: Numbers of classes, shape (N,), int; or values, shape (N, K).
        test: With the truth.
        null: The same of a method without a network.
    """
    if task.told is Told.CLASS:
        score = balanced_accuracy if task.look is Look.WINDOW else accuracy
        return [
            Scored(metric=task.metric, value=score(told, test.truth), null=score(null, test.truth))
        ]
    return [
        Scored(
            metric=f"mae_{name}",
            value=float(np.abs(told[:, k] - test.truth[:, k]).mean()),
            null=float(np.abs(null[:, k] - test.truth[:, k]).mean()),
        )
        for k, name in enumerate(test.outputs)
    ]


def trivial(task: Task, train: Examples, test: Examples) -> np.ndarray:
    """What the task's trivial method says of the test, as `scored` takes it."""
    count = len(test)
    if task.null is Null.MAJORITY:
        classes, often = np.unique(train.truth, return_counts=True)
        return np.full(count, classes[np.argmax(often)])
    if task.null is Null.MOTION:
        return (test.motion > best_threshold(train.motion, train.truth)).astype(np.int64)
    middle = np.median if task.null is Null.MEDIAN else np.mean
    return np.tile(middle(train.truth, axis=0), (count, 1))


def best_threshold(values: np.ndarray, truth: np.ndarray) -> float:
    """The value above which slip is told, with the best balanced accuracy of all."""
    edges = np.unique(values)
    middles = np.concatenate([[edges[0] - 1.0], 0.5 * (edges[1:] + edges[:-1])])
    found = [balanced_accuracy((values > at).astype(int), truth) for at in middles]
    return float(middles[int(np.argmax(found))])


def accuracy(told: np.ndarray, truth: np.ndarray) -> float:
    """Share that is told right."""
    return float((told == truth).mean())


def balanced_accuracy(told: np.ndarray, truth: np.ndarray) -> float:
    """Mean over the classes that occur of the share of each that is told right."""
    return float(np.mean([(told[truth == each] == each).mean() for each in np.unique(truth)]))


def confusion(told: np.ndarray, truth: np.ndarray, classes: int) -> np.ndarray:
    """How often class i was told as class j, shape (classes, classes)."""
    found = np.zeros((classes, classes), np.int64)
    np.add.at(found, (truth, told), 1)
    return found


def rank_correlation(told: np.ndarray, truth: np.ndarray) -> float:
    """Spearman's rank correlation; 0 where either does not vary."""
    if np.ptp(told) == 0.0 or np.ptp(truth) == 0.0:
        return 0.0
    from scipy.stats import spearmanr

    found: Any = spearmanr(told, truth)
    return float(found.statistic)
