"""Heads over features of a network that does not learn."""

from __future__ import annotations

import numpy as np
import pytest
import torch

from tests.synthetic_touches import HEIGHT, WIDTH, picture
from workbench.core.base.monitor import silent
from workbench.tasks.networks.learn import Part, told_by
from workbench.tasks.networks.lite import PENALTIES, Head, features, fit_values, installed
from workbench.tasks.seen_images import change, whole
from workbench.tasks.task import Net

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
    head = Head(2, train)
    learned = fit_values(head, (train, validation))
    left = np.abs(told_by(head, test.inputs, test.at) - test.truth).mean()
    assert left < 0.15 * np.abs(test.truth).mean()
    assert learned.curve[learned.epoch - 1]["validation"] == min(
        each["validation"] for each in learned.curve
    )


def test_where_nothing_can_be_told_the_largest_penalty_is_best() -> None:
    """Noise: the head falls back to the mean, as the null does."""
    rng = np.random.default_rng(1)
    noise = [rng.normal(size=(count, 1)).astype(np.float32) for count in (60, 200)]
    train, validation = part(rng, 60, noise[0]), part(rng, 200, noise[1])
    assert fit_values(Head(1, train), (train, validation)).epoch == len(PENALTIES)


def test_a_head_tells_windows_by_their_order() -> None:
    """The same images in another order are told otherwise; a single image has no order."""
    rng = np.random.default_rng(2)
    one = part(rng, 6)
    window = Part(inputs=rng.normal(size=(6, 1, 8, FEATURES)), at=one.at, truth=one.truth)
    torch.manual_seed(0)
    head = Head(2, window)
    there, back = (
        told_by(head, each, one.at) for each in (window.inputs, window.inputs[:, :, ::-1].copy())
    )
    assert there.shape == (6, 2) and np.abs(there - back).max() > 1e-3


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
