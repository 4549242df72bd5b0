"""Dents that are drawn from shapes: exact heights, and what a network learns of them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import torch

from workbench.core.base.errors import Cancelled
from workbench.core.base.monitor import silent
from workbench.tasks.examples import Examples
from workbench.tasks.features import usual_network
from workbench.tasks.networks import dent
from workbench.tasks.networks.dent import DentNet, Lesson, drawable, in_the_middle, learn_dents
from workbench.tasks.networks.dents import (
    CELLS,
    NOWHERE_MM,
    REACH_MM,
    SPREADS,
    Dents,
    blurred,
    height_mm,
    sprung,
)
from workbench.tasks.networks.learn import Part, told_by
from workbench.tasks.networks.patch import GREY_PER_MM, PATCH_PX
from workbench.tasks.splits import by_place
from workbench.tasks.task import Net, task_of
from workbench.tasks.trained import Trainer

KINDS = ("sphere", "cross", "cylinder_side")
CLOSE_MM = 1e-6


def off_mm() -> np.ndarray:
    """Distance of the cells of a height from its middle."""
    steps = ((np.arange(CELLS) + 0.5) / CELLS * 2.0 - 1.0) * REACH_MM
    return np.hypot(*np.meshgrid(steps, steps))


def test_the_lower_side_of_a_ball_is_a_circle() -> None:
    """r - sqrt(r2 - rho2) to a nanometre; beside it there is nothing."""
    radius_mm = 3.05
    found, away = height_mm("sphere", 2.0 * radius_mm), off_mm()
    below = away < 0.95 * radius_mm
    wanted = radius_mm - np.sqrt(np.maximum(radius_mm**2 - away**2, 0.0))
    assert found[below] == pytest.approx(wanted[below], abs=CLOSE_MM)
    assert (found[away > 1.05 * radius_mm] == NOWHERE_MM).all()


def test_the_end_of_a_prism_is_flat_up_to_its_rounded_edge() -> None:
    """A hexagon of 8 mm from corner to corner: its inscribed circle has 4 cos 30 mm."""
    found, away = height_mm("hexagon", 8.0), off_mm()
    flat_mm = 4.0 * np.cos(np.pi / 6.0) - 0.45
    assert found[away < flat_mm - 0.1] == pytest.approx(0.0, abs=CLOSE_MM)
    assert (found[away > 4.1] == NOWHERE_MM).all()


def test_skin_beside_a_contact_comes_along_and_no_deeper() -> None:
    """It is never less deep than the object, falls outward, and ends after so many pixels."""
    pressed = torch.zeros((1, 1, PATCH_PX, PATCH_PX))
    pressed[0, 0, 30:34, 30:34] = 0.5
    found = sprung(pressed, 0.9)
    assert (found >= pressed).all() and float(found.max()) == 0.5
    line = found[0, 0, 32, 33 : 33 + SPREADS + 2]
    assert (line.diff() <= 0.0).all() and float(line[1]) > 0.0
    assert float(line[SPREADS + 1]) == 0.0


def test_a_blur_keeps_what_there_is() -> None:
    """Sum and middle stay; the spread is that of the Gaussian."""
    spot = torch.zeros((1, 1, 41, 41))
    spot[0, 0, 20, 20] = 1.0
    found = blurred(spot, 2.0)[0, 0].numpy()
    places = np.arange(41) - 20.0
    assert found.sum() == pytest.approx(1.0, abs=1e-5)
    assert (found.sum(axis=0) * places**2).sum() == pytest.approx(4.0, rel=0.03)


def test_dents_are_drawn_alike_by_the_same_seed() -> None:
    """All kinds occur, no dent is deeper than is asked for and 15 % of gain and stripes more."""
    first, second, other = (Dents(KINDS, seed, "cpu").draw(200) for seed in (1, 1, 2))
    assert torch.equal(first[0], second[0]) and torch.equal(first[1], second[1])
    assert not torch.equal(first[0], other[0])
    assert set(first[1].tolist()) == {0, 1, 2}
    assert first[0].shape == (200, 2, PATCH_PX, PATCH_PX)
    assert 0.2 < float(first[0][:, 0].max()) < 2.0


def test_a_dent_is_moved_to_the_middle() -> None:
    """A ball's dent at one side: its centre of mass is the image's to a tenth of a pixel."""
    places = torch.arange(PATCH_PX, dtype=torch.float32)
    down, across = torch.meshgrid(places, places, indexing="ij")
    one = torch.exp(-((down - 22.0) ** 2 + (across - 40.0) ** 2) / 18.0)[None, None]
    found, skin = in_the_middle(torch.cat([one, one], dim=1))[0]
    assert torch.equal(found, skin)
    middle = 0.5 * (PATCH_PX - 1)
    for axis in (0, 1):
        weight = found.sum(dim=1 - axis)
        assert float((weight * places).sum() / weight.sum()) == pytest.approx(middle, abs=0.1)


def test_turned_and_mirrored_the_same_is_told() -> None:
    """Of eight ways round, exactly."""
    torch.manual_seed(0)
    network = DentNet(4).eval()
    shown = torch.rand((2, 1, 3, PATCH_PX, PATCH_PX))
    with torch.no_grad():
        first = network(shown, torch.zeros((2, 8)))
        for way in (torch.rot90(shown, 1, (3, 4)), shown.flip(4), shown.flip(3)):
            told = network(way, torch.zeros((2, 8)))
            assert told.numpy() == pytest.approx(first.numpy(), abs=1e-4)


def pressed(count: int, seed: int) -> Part:
    """Drawn dents as a task shows pressed ones."""
    dents_mm, classes = Dents(KINDS, seed, "cpu").draw(count)
    grey = np.rint(GREY_PER_MM * dents_mm.numpy()).astype(np.int16)
    return Part(
        inputs=grey.transpose(0, 2, 3, 1)[:, None][..., [0, 0, 1]],
        at=np.zeros((count, 8), np.float32),
        truth=classes.numpy(),
    )


@pytest.fixture
def brief(monkeypatch: pytest.MonkeyPatch) -> None:
    """A fifteenth of the steps."""
    monkeypatch.setattr(dent, "TAUGHT_STEPS", 130)
    monkeypatch.setattr(dent, "FEWEST_STEPS", 20)


def test_drawn_dents_teach_what_few_pressed_ones_could_not(tmp_path: Path, brief: None) -> None:
    """Twelve examples, told of others: over .8 with drawn dents, less without; chance is a third.

    The second training takes what the first was taught; ended in mid-lesson nothing is kept.
    """
    parts, test = (pressed(12, 5), pressed(12, 6)), pressed(150, 7)
    steps: list[str] = []

    def right(names: tuple[str, ...], name: str) -> float:
        torch.manual_seed(0)
        network = DentNet(3)
        lesson = Lesson(names=names, seed=0, kept=tmp_path / name)
        learn_dents(network, parts, lesson, lambda fraction, note="": steps.append(note))
        told = told_by(network, test.inputs, test.at)
        return float((told.argmax(axis=1) == test.truth).mean())

    taught = right(KINDS, "drawn.pt")
    assert taught > 0.8
    assert any("drawn" in step for step in steps)
    assert right(("a", "b", "c"), "none.pt") < taught - 0.1
    steps.clear()
    assert right(KINDS, "drawn.pt") > 0.8
    assert not any("drawn" in step for step in steps)


def test_a_lesson_is_cancelled_at_once(
    tmp_path: Path, brief: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    """In its first part, and nothing is kept of it."""
    monkeypatch.setattr(dent, "TAUGHT_STEPS", 4)

    def stop(fraction: float, note: str = "") -> None:
        raise Cancelled("enough")

    lesson = Lesson(names=KINDS, seed=0, kept=tmp_path / "drawn.pt")
    with pytest.raises(Cancelled):
        learn_dents(DentNet(3), (pressed(12, 5), pressed(12, 6)), lesson, stop)
    assert not lesson.kept.exists()
    learn_dents(DentNet(3), (pressed(12, 5), pressed(12, 6)), lesson, silent)
    assert lesson.kept.exists()


def test_only_shapes_that_are_known_are_drawn() -> None:
    """Not those of the user's classes, nor a mesh of the designer's own."""
    assert drawable(KINDS)
    assert not drawable(("sphere", "thumb"))
    assert not drawable(("sphere", "mesh"))


def test_a_task_keeps_what_it_learned_of_dents(tmp_path: Path, brief: None) -> None:
    """By its trainer: read again the same is told; where drawn dents taught is beside it."""
    part = pressed(40, 8)
    found = Examples(
        names=tuple(map(str, range(40))),
        places=np.array([f"place{k % 8}" for k in range(40)]),
        inputs=part.inputs,
        at=part.at,
        feet_mm=np.zeros((40, 3)),
        axes=np.tile(np.eye(3), (40, 1, 1)),
        motion=np.zeros(40),
        truth=part.truth,
        outputs=KINDS,
    )
    task = task_of("objects")
    assert usual_network(task) is Net.DENT
    trainer = Trainer(task=task, net=Net.DENT, folder=tmp_path, safety=None, device="cpu")
    first = trainer.trained("sim", found, by_place(found.places, 0), 0, silent)
    assert (first.told(found) == found.truth).mean() > 0.7
    assert {path.name for path in tmp_path.iterdir()} == {"drawn-dents.pt", "sim-seed0.pt"}
    assert trainer.learning["taught_steps"] == dent.SETTINGS["taught_steps"]

    def refuse(fraction: float, note: str = "") -> None:
        raise AssertionError("it learns again")

    again = trainer.trained("sim", found, by_place(found.places, 0), 0, refuse)
    assert (again.told(found) == first.told(found)).all()
