"""What a task saw stays: it is read where it is of the same, and seen anew where it is not."""

from __future__ import annotations

import dataclasses
import json
from pathlib import Path

import numpy as np
import pytest

from workbench.planning.stage_table import STAGES
from workbench.tasks.examples import Examples
from workbench.tasks.kept import kept_key
from workbench.tasks.kept.step_times import StepTimes
from workbench.tasks.kept_examples import kept_examples


def found() -> Examples:
    rng = np.random.default_rng(1)
    return Examples(
        names=("a:0", "b:1", "b:2"),
        places=np.array(["tip", "side", ""]),
        inputs=rng.integers(-255, 256, (3, 1, 4, 4, 3)).astype(np.int16),
        at=rng.normal(size=(3, 8)).astype(np.float32),
        feet_mm=rng.normal(size=(3, 3)),
        axes=np.tile(np.eye(3), (3, 1, 1)),
        motion=np.zeros(3),
        truth=np.array([0, 1, 1]),
        outputs=("ball", "cube"),
    )


class Eyes:
    """Sees, and counts how often."""

    def __init__(self) -> None:
        self.asked = 0

    def __call__(self) -> Examples:
        self.asked += 1
        return found()


def test_what_was_seen_is_read_again(tmp_path: Path) -> None:
    """Exact, each array with its kind of number; nothing is seen twice."""
    path, see = tmp_path / "seen.npz", Eyes()
    first, again = (kept_examples(path, ["recipe", 3], see) for _ in range(2))
    assert see.asked == 1
    assert list(tmp_path.iterdir()) == [path]
    for field in dataclasses.fields(Examples):
        one, other = getattr(first, field.name), getattr(again, field.name)
        np.testing.assert_array_equal(one, other)
        if isinstance(one, np.ndarray):
            assert one.dtype == other.dtype
    assert again.names == first.names
    assert again.outputs == first.outputs


@pytest.mark.parametrize("what", ["recipe", "code", "stage", "truncated", "rubbish"])
def test_what_is_of_something_else_is_seen_anew(
    what: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """And kept in its place."""
    path, see = tmp_path / "seen.npz", Eyes()
    kept_examples(path, ["recipe"], see)
    rests_on: list[object] = ["another"] if what == "recipe" else ["recipe"]
    if what == "stage":
        raised = dataclasses.replace(STAGES["bake"], version=99)
        monkeypatch.setitem(kept_key.STAGES, "bake", raised)
    if what == "code":
        monkeypatch.setattr(kept_key, "code_digest", lambda sources: "of another day")
    if what == "truncated":
        path.write_bytes(path.read_bytes()[:-200])
    if what == "rubbish":
        path.write_bytes(b"rubbish")
    for _ in range(2):
        kept_examples(path, rests_on, see)
    assert see.asked == 2


def test_times_of_a_step_add_up_over_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Also of one that was stopped inside; another task begins at nothing."""
    clock = iter([0.0, 2.0, 10.0, 13.0, 20.0, 21.0])
    monkeypatch.setattr("workbench.tasks.kept.step_times.time.monotonic", lambda: next(clock))
    path = tmp_path / "times.json"
    times = StepTimes(path, "one")
    with times.of("data"):
        pass
    with pytest.raises(KeyboardInterrupt), times.of("images"):
        raise KeyboardInterrupt
    later = StepTimes(path, "one")
    assert later.seconds == {"data": 2.0, "images": 3.0}
    with later.of("images"):
        pass
    assert StepTimes(path, "one").seconds == {"data": 2.0, "images": 4.0}
    assert StepTimes(path, "another").seconds == {}
    path.write_text(json.dumps([1]))
    assert StepTimes(path, "one").seconds == {}
