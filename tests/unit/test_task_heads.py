"""Heads over features of a network that does not learn."""

from __future__ import annotations

import numpy as np
import pytest

from tests.synthetic_touches import HEIGHT, WIDTH, picture
from workbench.core.base.monitor import silent
from workbench.tasks.networks.head import PENALTIES, Head, fit_values, ridge
from workbench.tasks.networks.learn import Part, told_by
from workbench.tasks.networks.lite import features, installed
from workbench.tasks.seen_images import change, whole
from workbench.tasks.task import Net, task_of
from workbench.tasks.trained import made

FEATURES = 40


def part(rng: np.random.Generator, count: int, truth: np.ndarray | None = None) -> Part:
    """Features at random; told are two sums of them, or what is given."""
    seen = rng.normal(size=(count, 2, 1, FEATURES)).astype(np.float16)
    seen[:, 1] = seen[:, 0]
    flat = seen[:, 0, 0].astype(np.float64)
    told = np.stack([flat[:, :3].sum(axis=1), 2.0 * flat[:, 5]], axis=1)
    return Part(
        inputs=seen,
        at=rng.normal(size=(count, 8)).astype(np.float32),
        truth=told.astype(np.float32) if truth is None else truth,
    )


def test_values_that_are_sums_of_features_are_found() -> None:
    """300 examples of 40 features: a tenth or so is left of what the mean leaves."""
    rng = np.random.default_rng(0)
    train, validation, test = (part(rng, count) for count in (300, 60, 60))
    head = Head(2, train, told_places=True)
    learned = fit_values(head, (train, validation))
    left = np.abs(told_by(head, test.inputs, test.at) - test.truth).mean()
    assert left < 0.15 * np.abs(test.truth).mean()
    assert learned.curve[learned.epoch - 1]["validation"] == min(
        each["validation"] for each in learned.curve
    )


def test_who_is_cautious_takes_the_largest_penalty_that_is_no_worse_by_chance() -> None:
    """Of noisy sums: within a standard error of the least error, and none beyond it is."""
    rng = np.random.default_rng(3)
    train, validation = part(rng, 60), part(rng, 40)
    for one in (train, validation):
        one.truth[:] += 1.5 * rng.normal(size=one.truth.shape)
    heads = [Head(2, train, told_places=False) for _ in range(2)]
    best, kept = (
        fit_values(head, (train, validation), cautious=cautious)
        for head, cautious in zip(heads, (False, True), strict=True)
    )
    told = told_by(heads[0], validation.inputs, validation.at)
    errors = np.abs(told - validation.truth).mean(axis=1)
    most = errors.mean() + errors.std() / np.sqrt(len(errors))
    assert kept.epoch > best.epoch
    assert kept.curve[kept.epoch - 1]["validation"] <= most
    assert all(each["validation"] > most for each in kept.curve[kept.epoch :])


@pytest.mark.parametrize("count", [30, 90])
def test_ridge_regression_is_least_squares_with_rows_of_the_penalty(count: int) -> None:
    """Fewer and more examples than features: NumPy's lstsq of the rows and of sqrt(p) times I."""
    rng = np.random.default_rng(7)
    known, truth = rng.normal(size=(count, FEATURES)), rng.normal(size=(count, 2))
    for penalty, found in zip(PENALTIES, ridge(known, truth), strict=True):
        rows = np.concatenate([known, np.sqrt(penalty) * np.eye(FEATURES)])
        wanted = np.concatenate([truth, np.zeros((FEATURES, 2))])
        assert found == pytest.approx(np.linalg.lstsq(rows, wanted, rcond=None)[0], abs=1e-10)


def test_where_nothing_can_be_told_the_largest_penalty_is_best() -> None:
    """Noise: the head falls back to the mean, as the null does."""
    rng = np.random.default_rng(1)
    noise = [rng.normal(size=(count, 1)).astype(np.float32) for count in (60, 200)]
    train, validation = part(rng, 60, noise[0]), part(rng, 200, noise[1])
    assert fit_values(Head(1, train, told_places=True), (train, validation)).epoch == len(PENALTIES)


@pytest.mark.parametrize(
    ("task", "net", "told"),
    [("slip", Net.MOTION, False), ("safety", Net.MEASURES, False), ("pose", Net.LITE, True)],
)
def test_slips_and_pressures_are_told_without_the_place(task: str, net: Net, told: bool) -> None:
    """Elsewhere the same is told; a head for places hears of it."""
    one = part(np.random.default_rng(5), 30)
    head, _ = made(net, task_of(task), 2, one)
    here, there = (told_by(head, one.inputs, one.at + off) for off in (0.0, 1.0))
    assert (here == there).all() == (not told)


@pytest.mark.skipif(not installed(), reason="needs the extra `tasks`")
def test_what_it_sees_tells_rings_from_discs_wherever_they_are() -> None:
    """Of 12 spots the nearest in features to each other one has its shape: a ring or a disc."""
    rng = np.random.default_rng(3)
    idle = picture("disc", (0.0, 0.0), 0.0)
    inputs, kinds = [], []
    for number in range(24):
        middle = (WIDTH * rng.uniform(0.3, 0.7), HEIGHT * rng.uniform(0.3, 0.7))
        image = picture("ring" if number % 2 else "disc", middle, 100.0)
        inputs.append(change([image], idle, whole(Net.LITE)).grey)
        kinds.append(number % 2)
    seen = features(np.stack(inputs), silent, copies=0, moved=False, device="cpu")[:, 0, 0]
    seen, known = seen.astype(np.float64), np.array(kinds)
    apart = np.linalg.norm(seen[12:, None] - seen[None, :12], axis=2)
    assert (known[:12][apart.argmin(axis=1)] == known[12:]).all()
