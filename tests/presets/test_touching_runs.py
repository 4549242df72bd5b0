"""Objects on feet as the command line presses them: what is said, and what a turn changes."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.made_indenters import on_a_foot, write_stl
from tests.presets.conftest import Command

pytestmark = [pytest.mark.slow, pytest.mark.usefixtures("shared_results")]
TOUCH = ("--target", "0,0,16", "--depth-mm", 0.6, "--frames", 2, "--grid-mm", 0.8)
TURNED = ("--turn-deg", "180,0,0")


def pressed(workbench: Command, coarse: Path, file: Path, *words: Any) -> tuple[Any, str]:
    """Summary of a press of a file into the coarse finger, and what was said."""
    out = file.parent / "-".join((file.stem, *words[1:]))
    found = workbench("run", coarse, "--indenter", file, *TOUCH, *words, "--out", out)
    assert found.code == 0, found.stderr
    return json.loads((out / "summary.json").read_text()), found.stderr


def test_feet_press_alike_until_they_are_turned_over(
    workbench: Command, coarse: Path, tmp_path: Path
) -> None:
    """A ball and a cross press one square: the same force. Turned they press themselves."""
    forces: dict[tuple[str, bool], float] = {}
    for name in ("sphere", "cross"):
        file = write_stl(on_a_foot(name), tmp_path / f"{name}.stl")
        for words in ((), TURNED):
            summary, said = pressed(workbench, coarse, file, *words)
            forces[name, bool(words)] = summary["contact"]["normal_N"]
            assert summary["press"]["turn_deg"] == ([180.0, 0.0, 0.0] if words else [0.0] * 3)
            assert summary["press"]["target_mm"] == pytest.approx([0.0, 0.0, 16.0], abs=0.02)
            assert ("--turn-deg 180,0,0" in said) is not bool(words)
            assert ("object" in summary["notices"]) is not bool(words)
    flat = [forces[name, False] for name in ("sphere", "cross")]
    turned = [forces[name, True] for name in ("sphere", "cross")]
    assert flat[0] == pytest.approx(flat[1], rel=1e-3)
    assert abs(np.log(turned[0] / turned[1])) > 0.1


@pytest.mark.parametrize(
    ("one", "turned"),
    [
        (("cube",), ("cube", "--turn-deg", "0,90,0")),
        (("cylinder_side",), ("cylinder_end", "--turn-deg", "-90,0,0")),
    ],
)
def test_a_turned_shape_presses_as_its_like_does(
    workbench: Command,
    coarse: Path,
    tmp_path: Path,
    one: tuple[str, ...],
    turned: tuple[str, ...],
) -> None:
    """A cube on another face, a cylinder laid down: the force of the closed form within 1 %."""
    forces = []
    for words in (one, turned):
        out = tmp_path / "-".join(words)
        size = ("--size-mm", 5, "--indenter")
        found = workbench("run", coarse, *TOUCH, *size, *words, "--out", out)
        assert found.code == 0, found.stderr
        forces.append(json.loads((out / "summary.json").read_text())["contact"]["normal_N"])
    assert forces[1] == pytest.approx(forces[0], rel=0.01)


def test_a_target_on_the_wall_is_pressed_where_it_was_typed(
    workbench: Command, coarse: Path, tmp_path: Path
) -> None:
    """Finger of radius 8 with 8 mm of wall: 0, 8, 4 is pressed, and the summary says so."""
    out = tmp_path / "wall"
    words = ("--size-mm", 3, "--target", "0,8,4", "--depth-mm", 0.4, "--frames", 1)
    found = workbench("run", coarse, *words, "--grid-mm", 0.8, "--out", out)
    assert found.code == 0, found.stderr
    summary = json.loads((out / "summary.json").read_text())
    assert summary["press"]["target_mm"] == pytest.approx([0.0, 8.0, 4.0], abs=0.05)
    assert "target" not in summary["notices"]
