"""A committee of small networks over numbers of examples."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import torch

from workbench.core.base.errors import Cancelled
from workbench.core.base.monitor import silent
from workbench.tasks.networks.committee import MEMBERS, MOST, Committee, learn_committee
from workbench.tasks.networks.learn import Part, told_by

NUMBERS = 12


def part(rng: np.random.Generator, count: int, share: float = 0.5) -> Part:
    """Numbers at random; of class 1 are those whose first two are of one sign, a share is kept.

    No line between numbers tells them: a head is right by half.
    """
    seen = rng.normal(size=(6 * count, NUMBERS))
    truth = (seen[:, 0] * seen[:, 1] > 0.0).astype(np.int64)
    ones = np.flatnonzero(truth == 1)[: round(share * count)]
    rows = np.concatenate([ones, np.flatnonzero(truth == 0)[: count - len(ones)]])
    return Part(
        inputs=(3.0 * seen[rows] + 5.0).astype(np.float32)[:, None, None],
        at=rng.normal(size=(count, 8)).astype(np.float32),
        truth=truth[rows],
    )


def taught(train: Part, validation: Part, seed: int = 0) -> Committee:
    torch.manual_seed(seed)
    committee = Committee(2, train)
    learned = learn_committee(committee, (train, validation), seed, silent)
    assert learned.curve[-1]["validation"] < 0.2
    return committee


def test_it_tells_what_no_line_between_numbers_tells() -> None:
    """Signs of a product: over .85 of 400 that it did not learn from, each class as well.

    Of what it learns from one in five is of class 1: both are told right nearly as often.
    """
    rng = np.random.default_rng(0)
    train, test = part(rng, 800, 0.2), part(rng, 400)
    told = told_by(taught(train, part(rng, 200)), test.inputs, test.at).argmax(axis=1)
    right = [(told[test.truth == each] == each).mean() for each in (0, 1)]
    assert min(right) > 0.8
    assert np.mean(right) > 0.85


def test_shares_are_the_geometric_mean_of_the_members() -> None:
    """Beside a plain loop over members in NumPy; the place does not count."""
    rng = np.random.default_rng(1)
    train = part(rng, 40)
    torch.manual_seed(3)
    committee = Committee(3, train).eval()
    found = told_by(committee, train.inputs, train.at)
    seen = train.inputs[:, 0, 0].astype(np.float64)
    even = np.clip((seen - seen.mean(axis=0)) / seen.std(axis=0, ddof=0), -MOST, MOST)
    votes = np.zeros((40, 3))
    layers: list[Any] = list(committee.layers)
    for member in range(MEMBERS):
        values = even
        for number, layer in enumerate(layers):
            weight, bias = (each.detach().numpy()[member] for each in (layer.weight, layer.bias))
            values = values @ weight + bias
            values = np.maximum(values, 0.0) if number < 2 else values
        votes += (values - np.log(np.exp(values).sum(axis=1, keepdims=True))) / MEMBERS
    assert found == pytest.approx(votes, abs=1e-4)
    assert (told_by(committee, train.inputs, train.at + 1.0) == found).all()


def overlapping(rng: np.random.Generator, count: int, share: float) -> Part:
    """Two clouds one and a half standard deviations apart."""
    truth = (np.arange(count) < share * count).astype(np.int64)
    seen = rng.normal(size=(count, NUMBERS))
    seen[:, 0] += 1.5 * truth
    return Part(
        inputs=seen.astype(np.float32)[:, None, None],
        at=np.zeros((count, 8), np.float32),
        truth=truth,
    )


def test_a_rare_class_is_told_as_often_as_it_is_there() -> None:
    """One in twenty, of clouds that overlap: recalls within .15 of each other.

    With classes weighted in the loss of PyTorch the rare one was told always.
    """
    rng = np.random.default_rng(5)
    train, test = overlapping(rng, 3000, 0.05), overlapping(rng, 2000, 0.5)
    torch.manual_seed(0)
    committee = Committee(2, train)
    learn_committee(committee, (train, test), 0, silent)
    told = told_by(committee, test.inputs, test.at).argmax(axis=1)
    right = [(told[test.truth == each] == each).mean() for each in (0, 1)]
    assert abs(right[0] - right[1]) < 0.15
    assert min(right) > 0.65


def test_a_class_that_does_not_occur_is_never_told() -> None:
    rng = np.random.default_rng(6)
    train = part(rng, 40)
    only = Part(inputs=train.inputs, at=train.at, truth=np.zeros(40, np.int64))
    committee = Committee(2, only)
    learn_committee(committee, (only, only), 0, silent)
    assert (told_by(committee, only.inputs, only.at).argmax(axis=1) == 0).all()


def test_numbers_that_never_differ_do_no_harm() -> None:
    rng = np.random.default_rng(2)
    train = part(rng, 30)
    train.inputs[..., 4] = 7.0
    assert np.isfinite(told_by(Committee(2, train), train.inputs, train.at)).all()


def test_the_same_seed_learns_the_same_and_it_can_be_stopped() -> None:
    rng = np.random.default_rng(4)
    train, validation = part(rng, 600), part(rng, 100)
    first, again = (
        told_by(taught(train, validation), validation.inputs, validation.at) for _ in range(2)
    )
    assert (first == again).all()

    def stop(fraction: float, note: str = "") -> None:
        raise Cancelled("stopped")

    with pytest.raises(Cancelled):
        learn_committee(Committee(2, train), (train, validation), 0, stop)
