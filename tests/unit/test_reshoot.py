"""Presses seen anew: each once however windows overlap, and by every process with its own eyes."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.synthetic_touches import touched, with_windows
from workbench.core.base.monitor import silent
from workbench.learning.dataset.folder import DataSet
from workbench.tasks import reshoot
from workbench.tasks.rendered import Looker, rendered
from workbench.tasks.reshoot import Reshot
from workbench.tasks.seen_images import whole
from workbench.tasks.task import Net, task_of


class FakeCameras:
    """Shows how far the first vertex moved, and counts images; stays in its process."""

    def __init__(self) -> None:
        self.images = 0
        self.stays = lambda: None

    def image(self, displacement_mm: np.ndarray, *, marked: bool) -> np.ndarray:
        self.images += 1
        grey = int(1000.0 * np.abs(displacement_mm).max()) % 200 + int(marked)
        return np.full((24, 32, 3), grey, np.uint8)


class FakeSight:
    """Opens such cameras."""

    def cameras(self, mesh: Any, store: Any) -> FakeCameras:
        return FakeCameras()


class FakeMesh:
    """Of as many vertices as a press moves."""

    class seen:
        points_mm = np.ones((4, 3))


@pytest.fixture
def data(tmp_path: Path) -> DataSet:
    made = touched(tmp_path / "data", cases=6)
    with_windows(made, 2)
    return made


@pytest.fixture
def anew(monkeypatch: pytest.MonkeyPatch) -> Reshot:
    """One sensor's cameras, opened without a device."""
    monkeypatch.setattr(reshoot, "open_device", lambda: "cpu")
    found = Reshot.__new__(Reshot)
    state = {"_sights": [FakeSight()] * 9, "_store": None, "_mesh": FakeMesh(), "_marked": True}
    found.__dict__.update(state | {"_opened": {}, "_rest": {}, "_taken": {}, "_of": ""})
    return found


def test_images_that_windows_share_are_taken_once(data: DataSet, anew: Reshot) -> None:
    """Two windows of the same two frames in each of six slides: twelve images, not 24."""
    looker = Looker(view=whole(Net.OWN), data=data, images=anew)
    assert len(rendered(task_of("slip"), looker, silent)) == 12
    cameras = list(anew._opened.values())
    at_rest = len(anew._rest)
    assert sum(each.images for each in cameras) == 12 + at_rest  # type: ignore[attr-defined]


def test_processes_side_by_side_see_the_same(data: DataSet, anew: Reshot) -> None:
    """In the same order; what one has opened is opened by each anew."""
    task = task_of("slip")
    looker = Looker(view=whole(Net.OWN), data=data, images=anew)
    one = rendered(task, looker, silent)
    two = rendered(task, looker, silent, jobs=2)
    assert [each.name for each in two] == [each.name for each in one]
    assert len({each.change.grey.tobytes() for each in one}) > 1
    for ours, theirs in zip(one, two, strict=True):
        np.testing.assert_array_equal(ours.change.grey, theirs.change.grey)
        assert ours.motion == theirs.motion
