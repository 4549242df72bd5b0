"""Scores of tasks, and of what tells without a network."""

from __future__ import annotations

import numpy as np
import pytest

from workbench.tasks.examples import Examples
from workbench.tasks.safety_scale import SafetyScale
from workbench.tasks.scores import (
    balanced_accuracy,
    best_threshold,
    confusion,
    rank_correlation,
    scored,
    trivial,
)
from workbench.tasks.task import task_of


def some(
    truth: list[float] | list[list[float]] | np.ndarray,
    outputs: tuple[str, ...],
    motion: float = 0.0,
) -> Examples:
    """Examples of nothing, with a truth."""
    values = np.asarray(truth)
    return Examples(
        names=tuple(map(str, range(len(values)))),
        places=np.array(["here"] * len(values)),
        inputs=np.zeros((len(values), 1, 2, 2, 3), np.int16),
        at=np.zeros((len(values), 8), np.float32),
        feet_mm=np.zeros((len(values), 3)),
        axes=np.tile(np.eye(3), (len(values), 1, 1)),
        motion=np.full(len(values), motion),
        truth=values,
        outputs=outputs,
    )


def test_the_majority_of_training_is_told_of_every_object() -> None:
    """Class 2 is the most frequent; of the test it is 1 in 4: null .25, and a perfect score 1."""
    task = task_of("objects")
    train, test = some([0, 2, 2, 1], ("a", "b", "c")), some([0, 1, 2, 1], ("a", "b", "c"))
    null = trivial(task, train, test)
    assert null.tolist() == [2, 2, 2, 2]
    (row,) = scored(task, test.truth, test, null)
    assert (row.metric, row.value, row.null) == ("accuracy", 1.0, 0.25)


def test_the_median_is_told_of_pressure_and_the_mean_of_places() -> None:
    """Median of 0, 1, 5 is 1, mean 2: errors against 3 of 2 and 1."""
    train, test = some([[0.0], [1.0], [5.0]], ("value",)), some([[3.0]], ("value",))
    found = {}
    for name in ("safety", "pose"):
        task = task_of(name)
        (row,) = scored(task, np.array([[2.5]]), test, trivial(task, train, test))
        assert row.value == 0.5 and row.metric == "mae_value"
        found[name] = row.null
    assert found == {"safety": 2.0, "pose": 1.0}


def test_the_threshold_of_motion_is_the_best_of_the_training_part() -> None:
    """Still up to .02, slipping from .05 on: between them all are told right."""
    motion = np.array([0.01, 0.02, 0.05, 0.08])
    train = Examples(
        names=tuple("abcd"),
        places=np.array(list("abcd")),
        inputs=np.zeros((4, 8, 2, 2, 3), np.int16),
        at=np.zeros((4, 8), np.float32),
        feet_mm=np.zeros((4, 3)),
        axes=np.tile(np.eye(3), (4, 1, 1)),
        motion=motion,
        truth=np.array([0, 0, 1, 1]),
        outputs=("hold", "slip"),
    )
    assert best_threshold(train.motion, train.truth) == pytest.approx(0.035)
    assert trivial(task_of("slip"), train, train).tolist() == [0, 0, 1, 1]


def test_balanced_accuracy_counts_each_class_once() -> None:
    """9 of 10 hold and none of 2 slips told: .45, however many there are of each."""
    truth, told = np.array([0] * 10 + [1] * 2), np.array([0] * 9 + [1] + [0] * 2)
    assert balanced_accuracy(told, truth) == pytest.approx(0.45)
    assert confusion(told, truth, 2).tolist() == [[9, 1], [2, 0]]


def test_the_coefficient_goes_from_1_at_the_least_pressure_to_0_at_the_largest() -> None:
    """Low 1, high 3 MPa: 1 -> 1, 2 -> .5, 3 -> 0, beyond is cut; and back."""
    scale = SafetyScale.of(some([[1.0], [3.0]], ("peak_MPa",)))
    assert scale.safety(np.array([1.0, 2.0, 3.0, 9.0])).tolist() == [1.0, 0.5, 0.0, 0.0]
    level = scale.level(scale.with_safety(some([[1.0], [3.0], [np.sqrt(3.0)]], ("peak_MPa",))))
    assert level.ravel() == pytest.approx([0.0, 1.0, 0.5])
    assert scale.both(level)[:, 1] == pytest.approx([1.0, 3.0, np.sqrt(3.0)])
    assert scale.both(np.array([[-0.5], [99.0]])) == pytest.approx(
        np.array([[1.0, 1.0], [0.0, 9.0]])
    )
    assert scale.with_safety(some([[2.0]], ("peak_MPa",))).outputs == ("safety", "peak_MPa")


def test_levels_are_finite_where_nothing_was_pressed_or_all_alike() -> None:
    """Pressures below a fiftieth of the largest count as that; of equal ones each is told so."""
    scale = SafetyScale.of(some([[0.0], [0.2]], ("peak_MPa",)))
    found = scale.with_safety(some([[0.0], [0.004], [0.2]], ("peak_MPa",)))
    assert scale.level(found).ravel() == pytest.approx([0.0, 0.0, 1.0])
    alike = SafetyScale.of(some([[0.3], [0.3]], ("peak_MPa",)))
    found = alike.with_safety(some([[0.3]], ("peak_MPa",)))
    assert alike.both(alike.level(found))[0, 1] == pytest.approx(0.3)


def test_ranks_agree_where_order_does() -> None:
    """Spearman of x and x cubed is 1; of a constant there is none, told as 0."""
    x = np.linspace(-1.0, 1.0, 9)
    assert rank_correlation(x**3, x) == pytest.approx(1.0)
    assert rank_correlation(np.zeros(9), x) == 0.0
