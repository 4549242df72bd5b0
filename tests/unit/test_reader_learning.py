"""Teaching a reader: views and their files, learning, going on, honest deviations, the card."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import torch

from sim.reading.network.spec import INPUTS, Scales
from sim.reading.network.unet import network_of
from tests.made_readers import COLUMNS, NEWTON_PER_MM, ROWS, rest_view, spec, views
from workbench.core.base.errors import Cancelled, StoreError
from workbench.learning.readers import learn as learning
from workbench.learning.readers.learn import learn
from workbench.learning.readers.lesson import RATE, Lesson
from workbench.learning.readers.making import Amount, _shares, blocks_of
from workbench.learning.readers.scoring import honest, judged, scores
from workbench.learning.readers.showing import BLOCK
from workbench.learning.readers.view import block_bytes, block_from, view_of

SCALES = Scales(pressure_MPa=0.1, force_N=1.0)


def lesson(**changes: object) -> Lesson:
    """A short training on made dents."""
    given = {
        "learned": views(48),
        "validation": views(16, seed=9),
        "spec": spec(),
        "scales": SCALES,
        "seconds": 1e3,
        "epochs": 1,
        "seed": 0,
        "device": "cpu",
        "key": "k" * 32,
    }
    return Lesson(**{**given, **changes})  # pyright: ignore[reportArgumentType]


def nobody(share: float, row: object) -> None:
    """Is told nothing."""


def test_a_block_of_views_is_the_same_from_its_file() -> None:
    """Byte for byte; a damaged one is refused by name."""
    made = list(views(5).views)
    content = block_bytes(made)
    for before, after in zip(made, block_from(content, "x"), strict=True):
        for name in ("photo", "depth_mm", "surface_mm", "turn", "pressure_MPa", "force_N"):
            assert np.array_equal(getattr(before, name), getattr(after, name)), name
        assert (before.look, before.box, before.solved) == (after.look, after.box, after.solved)
    with pytest.raises(StoreError, match="views x are damaged"):
        block_from(content[: len(content) // 2], "x")


def test_a_view_keeps_all_that_changed_and_no_more() -> None:
    """The batch shows photograph and truth as they were; without skin the truth is NaN."""
    rest = np.full((ROWS, COLUMNS, 3), 90, np.uint8)
    depth = np.zeros((ROWS, COLUMNS), np.float32)
    depth[5:9, 10:20] = 0.5
    depth[~rest_view().sees] = np.nan
    photo = rest.copy()
    photo[4:10, 9:22] = 70
    shown = SimpleNamespace(
        photo=photo,
        depth_mm=depth,
        surface_mm=np.nan_to_num(depth),
        turn=np.zeros((ROWS, COLUMNS, 3), np.float32),
        pressure_MPa=np.zeros((ROWS, COLUMNS), np.float32),
    )
    found = view_of(shown, (rest, rest_view().sees), look=0, name="a", force_N=None)  # pyright: ignore[reportArgumentType]
    assert found.box == (4, 10, 9, 22)
    assert not found.solved
    several = dataclasses.replace(
        views(1), views=[found], idle=np.stack([rest] * 2), sees=np.stack([rest_view().sees] * 2)
    )
    idle, photos, wanted = several.batch([0], "cpu")
    assert np.array_equal(photos[0].permute(1, 2, 0).numpy(), photo)
    assert np.array_equal(idle[0].permute(1, 2, 0).numpy(), rest)
    assert np.array_equal(wanted.depth_mm[0].numpy(), depth, equal_nan=True)
    assert float(wanted.solved[0]) == 0.0


def test_blocks_judge_by_sensors_that_nothing_is_learned_from() -> None:
    """Two looks more than are learned from; every process opens few."""
    amount = Amount(cases=1, views=40 * BLOCK, looks=6)
    blocks = blocks_of(amount)
    learned = [block for block in blocks if not block.judged]
    assert len(learned) == 40
    assert {block.look for block in learned} == set(range(6))
    assert {(block.look, block.half) for block in blocks if block.judged} == {(6, 0), (7, 1)}
    assert len({block.name for block in blocks}) == len(blocks)
    shares = _shares(blocks, 4)
    assert sorted(b.name for share in shares for b in share) == sorted(b.name for b in blocks)
    assert max(len({block.look for block in share}) for share in shares) <= 3
    for share in shares:
        assert [block.judged for block in share] == sorted((b.judged for b in share), reverse=True)


def test_a_short_training_beats_saying_nothing(tmp_path: Path) -> None:
    """On dents that darken a photograph in proportion, after four epochs of 48 views."""
    network, rows = learn(lesson(epochs=4), tmp_path, nobody)
    assert rows[-1]["epochs"] == pytest.approx(4.0)
    found = scores(judged(network, views(16, seed=5), SCALES, "cpu", most=16))
    assert found["depth_mae_mm"] < 0.9 * found["zero_mae_mm"]
    assert found["views"] == 16


def test_a_stopped_training_goes_on_and_another_is_refused(tmp_path: Path) -> None:
    """From its checkpoint; with other data it is another training."""

    def stop(share: float, row: object) -> None:
        if share >= 0.5:
            raise Cancelled("stopped", hint="train again")

    asked = lesson(epochs=2)
    pause = dataclasses.replace(asked, epochs=1)
    learn(pause, tmp_path, nobody)
    with pytest.raises(Cancelled):
        learn(asked, tmp_path, stop)
    _, rows = learn(asked, tmp_path, nobody)
    assert [row["views"] for row in rows] == [48, 96]
    with pytest.raises(StoreError, match="training of other data"):
        learn(lesson(key="other"), tmp_path, nobody)


def test_a_training_that_begins_from_a_reader_is_ahead(tmp_path: Path) -> None:
    """With nothing learned yet it says what the reader says; what it learned is whole in its file.

    From nothing the same two epochs end worse.
    """
    taught = lesson(epochs=6)
    network, _ = learn(taught, tmp_path / "before", nobody)
    start = taught.usable(network)
    asked = dataclasses.replace(lesson(epochs=2), start=start)
    images = torch.rand(2, INPUTS, 32, 48, generator=torch.Generator().manual_seed(1))
    with torch.inference_mode():
        for told, same in zip(asked.network()(images), network(images), strict=True):
            assert torch.allclose(told, same, atol=1e-4)
    kept, found = views(16, seed=5), list[float]()
    for each in (lesson(epochs=2), asked):
        learned, _ = learn(each, tmp_path / each.key / str(each.start is None), nobody)
        found.append(
            scores(judged(learned, kept, SCALES, "cpu", most=16))["depth_mae_mm"],
        )
        if each is asked:
            state = {name: torch.from_numpy(array) for name, array in asked.usable(learned).items()}
            again = network_of(asked.spec, state)
            assert torch.allclose(again(images)[0], learned(images)[0], atol=1e-5)
    assert found[1] < 0.9 * found[0]


def test_the_rate_ends_low() -> None:
    """It rises, then falls to its least."""
    rates = [learning._rate(RATE, done) for done in np.linspace(0.0, 1.0, 101)]
    assert np.argmax(rates) < 10
    assert rates[-1] == pytest.approx(learning.LAST_RATE)
    assert max(rates) == pytest.approx(RATE, rel=0.01)


def test_honest_scales_hold_two_thirds_of_the_errors(tmp_path: Path) -> None:
    """Of depths and of forces, on the views that they were found on."""
    network, _ = learn(lesson(epochs=1), tmp_path, nobody)
    kept = views(16, seed=5)
    found = scores(judged(network, kept, SCALES, "cpu", most=16))
    again = scores(judged(network, kept, honest(SCALES, found), "cpu", most=16))
    assert again["within_sigma"] == pytest.approx(0.683, abs=0.01)
    # Of 16 forces.
    assert again["force_within_sigma"] == pytest.approx(0.683, abs=0.07)


def test_forces_are_scored_beside_their_size() -> None:
    """A network that says nothing is off by the whole force."""
    from sim.reading.network.unet import UNet

    network = UNet(spec(), normed=True).eval()
    found = scores(judged(network, views(16, seed=2), SCALES, "cpu", most=16))
    assert found["force_error"] == pytest.approx(1.0, abs=0.1)
    assert found["depth_mae_mm"] == pytest.approx(found["zero_mae_mm"], abs=0.05)
    assert 0.3 * NEWTON_PER_MM < found["force_size_N"] < 1.2 * NEWTON_PER_MM
