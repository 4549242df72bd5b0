"""Making a twin: what is there is not made again, what fails is replaced, what stops goes on.

Contact and light are stood in for; `test_a_small_twin_end_to_end` has the real ones.
"""

from __future__ import annotations

import csv
import json
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from tests.unit.test_dataset_cases import flat_skin
from tests.unit.test_twin_cases import field
from workbench.cli.command_line import main
from workbench.cli.commands import twin as command
from workbench.core.base.errors import Cancelled, SolveError
from workbench.core.base.monitor import silent
from workbench.core.result.force_field import ForceField
from workbench.learning.dataset.sequences import FRAMES
from workbench.pipeline.store import Store
from workbench.project.named_designs import load_design
from workbench.twin import make as making
from workbench.twin.cases import Kind, TwinCase
from workbench.twin.make import make_twin, photo_names
from workbench.twin.twin_plan import Light, Solver, TwinPlan

PLAN = TwinPlan(calibration=6, presses=5, slides=2, width_px=32)


class Stand:
    """Contact and camera that count what is asked of them."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.photos: list[int] = []
        self.pressed: list[str] = []
        self.stop_after = 10**6
        self.mesh: Any = SimpleNamespace(outer=flat_skin(20.0, 1.0), tips_mm=np.zeros((0, 3)))
        self.mesh.seen = self.mesh.outer
        self.count = len(self.mesh.outer.points_mm)
        monkeypatch.setattr(making, "twin_mesh", lambda *given: self.mesh)
        monkeypatch.setattr(making, "SteadyPhotographer", lambda *given: self)
        monkeypatch.setattr(making, "pressed", self.press)
        middle = np.full((self.count, 3), 0.5) * (32.0, 24.0, 1.0)
        self.plain = SimpleNamespace(vertex_pixels=middle, visible=np.ones(self.count, bool))

    def press(self, twin: Any, plan: Any, case: TwinCase, store: Any, monitor: Any) -> ForceField:
        self.pressed.append(case.id)
        if case.id == "press0000":
            raise SolveError("frame 2 does not converge", hint="less deep")
        frames = case.press.frame_count
        share = np.where(np.arange(frames) >= 12, 1.0, 0.1)
        found = field(frames, share)
        object.__setattr__(found, "displacement_mm", np.zeros((frames, self.count, 3), np.float32))
        object.__setattr__(found, "pressure_MPa", np.zeros((frames, self.count), np.float32))
        object.__setattr__(found, "contact_force_N", np.zeros((frames, self.count, 3), np.float32))
        return found

    def at_rest(self, *, marked: bool = False) -> np.ndarray:
        return np.full((24, 32, 3), 200 if marked else 90, np.uint8)

    def photograph(
        self, moved: np.ndarray, number: int, monitor: Any, *, marked: bool = False
    ) -> np.ndarray:
        if len(self.photos) == self.stop_after:
            raise Cancelled("stopped")
        self.photos.append(number)
        return np.full((24, 32, 3), 91, np.uint8)


@pytest.fixture
def stand(monkeypatch: pytest.MonkeyPatch) -> Stand:
    return Stand(monkeypatch)


def made(folder: Path, plan: TwinPlan = PLAN) -> making.Made:
    return make_twin(load_design("pad"), folder / "twin", plan, Store(folder / "store"), silent)


def rows(folder: Path, name: str) -> list[dict[str, str]]:
    with (folder / "twin" / name).open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def test_folders_hold_what_was_asked_for(tmp_path: Path, stand: Stand) -> None:
    """Six balls, five presses, two sequences of eight; every photograph has its truth."""
    found = made(tmp_path)
    assert found.photos == {Kind.CALIBRATION: 6, Kind.PRESS: 5, Kind.SLIDE: 2 * FRAMES}
    names = [name for kind in Kind for name in photo_names(found.folder, kind)]
    assert len(names) == len(set(names)) == len(set(stand.photos)) == 27
    assert {path.stem for path in (found.folder / "truth").iterdir()} == set(names)
    table = rows(tmp_path, "slides/labels.csv")
    assert [row["slip"] for row in table] == ["0"] * FRAMES + ["1"] * FRAMES
    assert [row["frame"] for row in table[:FRAMES]] == [str(frame) for frame in range(FRAMES)]
    assert len(rows(tmp_path, "presses/labels.csv")) == 5
    assert len(rows(tmp_path, "calibration/presses.csv")) == 6
    card = json.loads((found.folder / "card.json").read_bytes())
    assert card["hidden"]["young_MPa"]["hidden"] != card["hidden"]["young_MPa"]["design"]
    design = load_design(str(found.folder / "design.toml"))
    assert (design.optics.camera.width_px, design.optics.camera.height_px) == (32, 24)
    assert design.material == load_design("pad").material


def test_a_path_that_fails_is_named_and_replaced(tmp_path: Path, stand: Stand) -> None:
    """And is not tried again."""
    found = made(tmp_path)
    assert found.failed == {"press0000": "frame 2 does not converge"}
    table = rows(tmp_path, "presses/labels.csv")
    assert [row["photo"][:9] for row in table] == ["press0001"] * 3 + ["press0002"] * 2
    stand.pressed.clear()
    made(tmp_path)
    assert "press0000" not in stand.pressed


def test_a_twin_that_was_stopped_goes_on(tmp_path: Path, stand: Stand) -> None:
    """Ten photographs, then the other seventeen, each once; finished, nothing is taken."""
    stand.stop_after = 10
    with pytest.raises(Cancelled):
        made(tmp_path)
    assert len(stand.photos) == 10
    stand.stop_after = 10**6
    made(tmp_path)
    assert len(stand.photos) == len(set(stand.photos)) == 27
    made(tmp_path)
    assert len(stand.photos) == 27


def test_more_photographs_begin_with_those_there_are(tmp_path: Path, stand: Stand) -> None:
    """Greater numbers only add."""
    made(tmp_path)
    before = rows(tmp_path, "presses/labels.csv")
    made(tmp_path, TwinPlan(calibration=6, presses=8, slides=2, width_px=32))
    after = rows(tmp_path, "presses/labels.csv")
    assert after[:5] == before
    assert len(after) == 8
    assert len(stand.photos) == 30


def test_most_paths_failing_ends_it(
    tmp_path: Path, stand: Stand, monkeypatch: pytest.MonkeyPatch
) -> None:
    """With how many photographs there are; not for ever."""

    def none(*given: Any) -> ForceField:
        raise SolveError("no frame converges", hint="")

    monkeypatch.setattr(making, "pressed", none)
    with pytest.raises(SolveError, match="only 0 of 6 photographs"):
        made(tmp_path)


def test_the_command_names_the_plan_s_own_numbers() -> None:
    """Its defaults and choices are typed twice, so that help needs no heavy import."""
    plan = TwinPlan()
    assert {name: getattr(plan, name) for name in command.USUAL} == command.USUAL
    assert command.SOLVERS == tuple(solver.value for solver in Solver)
    assert command.LIGHTS == tuple(light.value for light in Light)


def test_the_command_says_what_is_there(
    tmp_path: Path, stand: Stand, capsys: pytest.CaptureFixture[str]
) -> None:
    """And refuses numbers that make no sense, within a moment."""
    words = ["twin", "pad", "--project", str(tmp_path), "--out", str(tmp_path / "twin")]
    counts = ["--calibration", "5", "--presses", "3", "--slides", "0", "--width", "32"]
    assert main([*words, *counts, "--json"]) == 0
    last = json.loads(capsys.readouterr().out.splitlines()[-1])
    assert last["photos"] == {"calibration": 5, "press": 3, "slide": 0}
    assert main([*words, "--presses", "-2"]) == 2
    assert "-2" in capsys.readouterr().err


@pytest.mark.slow
@pytest.mark.usefixtures("taichi_device")
def test_a_small_twin_end_to_end(tmp_path: Path) -> None:
    """By the contact solver and a few photons: a dent darkens and brightens where it should be."""
    plan = TwinPlan(
        calibration=0,
        presses=1,
        slides=0,
        contact=Solver.MPM,
        photons_millions=1,
        width_px=160,
    )
    found = made(tmp_path, plan)
    import cv2

    place = found.folder / "presses"
    idle, photo = (
        np.asarray(cv2.imread(str(place / name)), dtype=float)
        for name in ("idle.png", "press0000_0.png")
    )
    changed = cv2.GaussianBlur(np.abs(photo - idle).max(axis=2), (0, 0), 3.0)
    assert changed.max() > 3.0 * np.median(changed)
    (row,) = rows(tmp_path, "presses/labels.csv")
    assert float(row["force_z_N"]) < 0.0
    with np.load(found.folder / "truth" / "press0000_0.npz") as truth:
        deepest_mm = (truth["rest_mm"] - truth["displaced_mm"])[:, 2].max()
    assert deepest_mm == pytest.approx(float(row["depth_mm"]), abs=0.05)
