"""A learned reader from nothing: presses, views, training, its file, a reading by it."""

from __future__ import annotations

import dataclasses
import json
from pathlib import Path

import numpy as np
import pytest

from sim.reading.network.reader_file import load_reader
from sim.reading.network.spec import SIZES
from workbench.core.base.errors import StoreError
from workbench.core.base.monitor import silent
from workbench.core.design.design import SensorDesign
from workbench.core.result.results import Skin
from workbench.learning.dataset.cases import cases_of
from workbench.learning.readers import making, presses, train_reader
from workbench.learning.readers.beginning import training_folder
from workbench.learning.readers.built import plain_design
from workbench.learning.readers.presses import press_recipe
from workbench.learning.readers.shipped_readers import shortcomings
from workbench.learning.readers.train_reader import ReaderPlan
from workbench.learning.training.checkpoint import CHECKPOINT
from workbench.project.named_designs import load_design
from workbench.project.project import Project
from workbench.reading.find_reader import find_reader, reader_path
from workbench.reading.reader_digest import reader_digest


def small(name: str = "pad") -> SensorDesign:
    """A preset, coarse and in light of few photons."""
    design = load_design(name)
    for field, value in (
        ("meshing.hex_mm", 1.0),
        ("optics.baking.photons", 20_000),
        ("optics.camera.width_px", 160),
        ("optics.camera.height_px", 120),
    ):
        design = design.replace(field, value)
    return design


def test_presses_fit_the_wall_and_judges_press_elsewhere() -> None:
    """Six tenths of a thin wall; the places of the two data sets differ."""
    design = load_design("geltip")
    assert press_recipe(design, judged=False).depth_mm == 1.2
    thin = press_recipe(design.replace("layers.elastomer_mm", 1.0), judged=False)
    assert thin.depth_mm == pytest.approx(0.6)
    assert thin.depth_steps == 4
    places = [
        {case.position.target_mm for case in cases_of(recipe, skin())}
        for recipe in (
            dataclasses.replace(
                press_recipe(design, judged=judged), cases=20, points=20, margin_mm=0.0
            )
            for judged in (False, True)
        )
    ]
    assert len(places[0] & places[1]) <= 4


def skin() -> Skin:
    """A flat skin of 900 vertices."""
    across, along = np.meshgrid(np.arange(30.0), np.arange(30.0))
    points = np.column_stack([across.ravel(), along.ravel(), np.zeros(900)])
    corner = np.array([row * 30 + column for row in range(29) for column in range(29)])
    faces = np.concatenate([np.stack([corner, corner + 1, corner + 31], 1)])
    return Skin(points_mm=points, faces=faces, normals=np.tile([0.0, 0.0, 1.0], (900, 1)))


def test_images_that_are_learned_from_have_no_noise_of_their_own() -> None:
    """It is drawn anew each time; all else stays."""
    design = load_design("pad").replace("optics.camera.sensor.noise", True)
    plain = plain_design(design)
    assert not plain.optics.camera.sensor.noise
    assert plain.replace("optics.camera.sensor.noise", True) == design


def test_presses_end_when_time_is_up_but_not_before_some_are_done() -> None:
    """The rest is left for another time."""
    from workbench.learning.making.watch import SetProgress

    tell = making._teller(silent, "presses", 0.0, 12)
    tell(SetProgress(done=11, total=100, failed=0, eta_s=None))
    with pytest.raises(making._TimeIsUp):
        tell(SetProgress(done=12, total=100, failed=0, eta_s=None))


def test_data_of_another_design_is_refused(tmp_path: Path) -> None:
    """Before anything is made or learned."""
    (tmp_path / train_reader.MADE).write_text(json.dumps({"digest": "other"}))
    with pytest.raises(StoreError, match="another design"):
        train_reader._make(
            small(),
            tmp_path,
            Project(tmp_path / "p"),
            ReaderPlan(),
            device="cpu",
            monitor=silent,
        )


def test_only_good_readers_ship() -> None:
    """By their error beside that of saying nothing, and by their deviations."""
    good = {"depth_mae_mm": 0.05, "zero_mae_mm": 0.5, "within_sigma": 0.68}
    assert shortcomings(good) == []
    (why,) = shortcomings({**good, "depth_mae_mm": 0.3})
    assert "0.60 of saying zero" in why
    (why,) = shortcomings({**good, "within_sigma": 0.9})
    assert "0.90 of the errors" in why


def unheard(stage: str, fraction: float, note: str) -> None:
    """Nobody watches."""


@pytest.mark.slow
def test_a_reader_is_made_from_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Five presses, three files of views, one epoch: not good, but whole, and found again."""
    for name, value in (("CLASSES", ["sphere"]), ("SIZE_MM", (4.0, 6.0)), ("DEPTH_MM", 0.3)):
        monkeypatch.setattr(presses, name, value)
    monkeypatch.setattr(presses, "STEPS", 1)
    monkeypatch.setattr(making, "LEAST_JUDGED", 3)
    monkeypatch.setitem(SIZES, "small", (8, 8, 12, 12))
    monkeypatch.setenv("WORKBENCH_DEVICE", "cpu")
    design, project = small(), Project(tmp_path / "p")
    out = reader_path(design, project)
    plan = ReaderPlan(minutes=60.0, epochs=1, presses=2, views=32, looks=1)
    rows: list[dict] = []
    done = train_reader.train_reader(design, out, project, plan, tell=rows.append, monitor=unheard)
    assert done.path == out
    assert 0.0 < done.scores["zero_mae_mm"] < 1.3
    assert np.isfinite(done.scores["force_error"])
    reader = find_reader(design, project, None)
    assert reader.digest == reader_digest(design)
    assert reader.card["data"]["built_sensors"] == 1
    assert reader.rest.sees.mean() > 0.5
    assert np.isfinite(reader.rest.vertex_px).any()
    assert out.with_name("pad-card.json").exists()
    again = train_reader.train_reader(design, out, project, plan, tell=rows.append, monitor=unheard)
    assert again.scores == done.scores
    # The same views are learned from anew, by one who begins from that reader.
    (training_folder(out) / CHECKPOINT).unlink()
    begun = dataclasses.replace(plan, start=reader)
    taught = train_reader.train_reader(
        design, out, project, begun, tell=rows.append, monitor=unheard
    )
    assert taught.before is not None
    assert taught.before["depth_mae_mm"] == pytest.approx(done.scores["depth_mae_mm"], rel=0.01)
    card = load_reader(taught.path).card
    assert card["scores"]["before"]["depth_mae_mm"] == taught.before["depth_mae_mm"]
    assert card["training"]["began_from"] == reader.card


def test_a_training_that_goes_on_tells_its_share_of_this_run() -> None:
    """From none to all, though half of it was over before."""
    shares: list[float] = []
    told = train_reader._teller(lambda row: None, lambda fraction, note="": shares.append(fraction))
    for share in (0.5, 0.75, 1.0):
        told(share, None)
    assert shares == pytest.approx([0.0, 0.5, 1.0])
