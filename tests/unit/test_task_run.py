"""Tasks learned from made-up images: networks learn, are kept, and all tests come out."""

from __future__ import annotations

import dataclasses
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.synthetic_touches import photographed, touched
from workbench.core.base.errors import DesignError
from workbench.core.base.monitor import silent
from workbench.learning.dataset.folder import DataSet
from workbench.project.named_designs import load_design
from workbench.project.project import Project
from workbench.tasks import run, trained
from workbench.tasks.examples import Examples
from workbench.tasks.lessons import SEEDS, Lessons
from workbench.tasks.outcome import Trial
from workbench.tasks.result_file import write_result
from workbench.tasks.splits import Parts
from workbench.tasks.task import Look, Net, task_of
from workbench.tasks.trained import Trainer

QUICK = {(Net.OWN, look): (16, 4e-3, 16, 1e-3) for look in Look}
"""Epochs, step, batch, decay."""


@pytest.fixture
def quick(monkeypatch: pytest.MonkeyPatch) -> None:
    """Few epochs."""
    monkeypatch.setattr(trained, "SETTINGS", trained.SETTINGS | QUICK)


@pytest.fixture
def brief(monkeypatch: pytest.MonkeyPatch) -> None:
    """Two epochs: for what is asked of any training, however little it learned."""
    two = {place: (2, *rest) for place, (_, *rest) in QUICK.items()}
    monkeypatch.setattr(trained, "SETTINGS", trained.SETTINGS | two)


def trainer(folder: Path, name: str) -> Trainer:
    """Of the small network, on the processor."""
    return Trainer(task=task_of(name), net=Net.OWN, folder=folder, safety=None, device="cpu")


def windows(count: int) -> Examples:
    """A spot that stays where it is, or moves by a pixel a frame: nothing else differs."""
    rng = np.random.default_rng(1)
    inputs = np.zeros((count, 8, 24, 32, 3), np.int16)
    truth = np.arange(count) % 2
    for number, slip in enumerate(truth):
        down, across = rng.integers(4, 14, 2)
        for frame in range(8):
            at = across + slip * frame
            inputs[number, frame, down : down + 6, at : at + 6] = 120
    return Examples(
        names=tuple(map(str, range(count))),
        places=np.array([f"place{k % 9}" for k in range(count)]),
        inputs=inputs,
        at=np.zeros((count, 8), np.float32),
        feet_mm=np.zeros((count, 3)),
        axes=np.tile(np.eye(3), (count, 1, 1)),
        motion=np.zeros(count),
        truth=truth.astype(np.int64),
        outputs=("hold", "slip"),
    )


def test_motion_tells_what_moves(tmp_path: Path) -> None:
    """No single image tells: accuracy over .85, of 50 windows that were not learned from."""
    found = windows(150)
    large = np.kron(found.inputs[:, :, :, :24], np.ones((1, 1, 2, 2, 1), np.int16))
    found = dataclasses.replace(
        found, inputs=np.pad(large, ((0, 0), (0, 0), (8, 8), (8, 8), (0, 0)))
    )
    parts = Parts(np.arange(80), np.arange(80, 100), np.arange(100, 150))
    teacher = dataclasses.replace(trainer(tmp_path, "slip"), net=Net.MOTION)
    learned = teacher.trained("net", found, parts, 0, silent)
    test = found.only(parts.test)
    assert (learned.told(test) == test.truth).mean() > 0.85


def test_a_training_is_kept_and_another_seed_is_another(tmp_path: Path, brief: None) -> None:
    """Read again it says the same, and nothing is learned."""
    found = windows(30)
    parts = Parts(np.arange(16), np.arange(16, 20), np.arange(20, 30))
    teacher = trainer(tmp_path, "slip")
    first = teacher.trained("net", found, parts, 0, silent)

    def refuse(fraction: float, note: str = "") -> None:
        raise AssertionError("it learns again")

    again = teacher.trained("net", found, parts, 0, refuse)
    assert again.curve == first.curve and again.epoch == first.epoch
    assert (again.told(found) == first.told(found)).all()
    with pytest.raises(AssertionError, match="learns again"):
        teacher.trained("net", found, parts, 1, refuse)
    (tmp_path / "net-seed0.pt").write_bytes(b"cut short")
    with pytest.raises(AssertionError, match="learns again"):
        teacher.trained("net", found, parts, 0, refuse)


def outcome(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str, photos: Path | None = None
) -> dict[str, Any]:
    """A task on made-up images in place of presses: what its file says."""
    data = touched(tmp_path / "made")
    monkeypatch.setattr(run, "make", lambda *given, **how: DataSet.open(data.folder))
    camera = dataclasses.replace(load_design("pad").optics.camera, width_px=192, height_px=144)
    design = load_design("pad").replace("optics.camera", camera)
    plan = run.Plan(task=name, net=Net.OWN, photos=photos, twin=False)
    out = tmp_path / "out"
    result = run.run_task(design, plan, out, Project(tmp_path / "project"), silent)
    write_result(out, result)
    return json.loads((out / "result.json").read_bytes())


@pytest.mark.slow
def test_objects_are_told_from_renders_and_from_photographs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, quick: None
) -> None:
    """Spots of four shapes, by a network of our own: at places never seen, and in another light.

    Null is about a quarter.
    """
    photos = photographed(tmp_path / "photos")
    found = outcome(tmp_path, monkeypatch, "objects", photos)
    rows = {row["test"]: row for row in found["rows"]}
    assert list(rows) == ["sim", "sim_by_place", "photos"]
    for row in rows.values():
        assert row["metric"] == "accuracy" and row["value"] > 0.7
        assert row["null"] < 0.45
    assert (rows["sim"]["paper"], rows["photos"]["paper"]) == (1.0, 0.913)
    assert rows["sim_by_place"]["paper"] is None
    details = found["details"]["tests"]["sim_by_place"]
    assert np.array(details["confusion"]).sum() == sum(details["tested_on"])
    assert "40 photographs at 7" in found["details"]["trained_on_photos"]["why_not"]
    assert "told as" in (tmp_path / "out" / "report.html").read_text()


@pytest.mark.slow
def test_safety_is_told_as_coefficient_and_as_pressure(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, quick: None
) -> None:
    """Both beat the median by half; a pressure told is off by no less than its coefficient.

    What is told beyond the range is cut in the coefficient alone. There are but two depths, so most
    ranks are shared: .7 was measured.
    """
    found = outcome(tmp_path, monkeypatch, "safety")
    details = found["details"]
    span_MPa = details["high_MPa"] - details["low_MPa"]
    for test in ("sim", "sim_by_place"):
        own = {row["metric"]: row for row in found["rows"] if row["test"] == test}
        safety, peak = own["mae_safety"], own["mae_peak_MPa"]
        assert safety["value"] < 0.5 * safety["null"]
        assert peak["value"] < 0.5 * peak["null"]
        assert peak["null"] == pytest.approx(span_MPa * safety["null"])
        assert peak["value"] > 0.999 * span_MPa * safety["value"]
        assert details["tests"][test]["rank_correlation"]["safety"] > 0.5


def test_photographs_that_do_not_suit_are_told_before_anything_is_pressed(tmp_path: Path) -> None:
    """Slip needs sequences; neither data nor networks are begun."""
    photos = photographed(tmp_path / "photos", 4)
    plan = run.Plan(task="slip", photos=photos, twin=False)
    with pytest.raises(DesignError, match="has no column slip"):
        run.run_task(load_design("pad"), plan, tmp_path / "out", Project(tmp_path / "p"), silent)
    assert not (tmp_path / "out").exists()


def test_spreads_are_those_of_three_seeds(tmp_path: Path, brief: None) -> None:
    """Three networks, three values, their standard deviation."""
    found = windows(15)
    lessons = Lessons(
        name="slip", task=task_of("slip"), trainer=trainer(tmp_path, "slip"), found=found
    )
    told = lessons.on_renders(Trial.PLACE, lessons.learned(Trial.PLACE, silent))
    values = [each["values"]["balanced_accuracy"] for each in told.details["seeds"]]
    assert len(values) == len(SEEDS)
    assert told.rows[0].value == pytest.approx(np.mean(values))
    assert told.rows[0].spread == pytest.approx(np.std(values, ddof=1))
