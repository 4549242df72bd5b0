"""Unit, turns, cut and repair of a body from a file, as the command line takes them."""

from __future__ import annotations

from pathlib import Path

import pytest
import trimesh

from workbench.cli.body_arguments import placed_design
from workbench.cli.command_line import _join_negative, parser
from workbench.core.base.errors import DesignError
from workbench.core.design.imported import LengthUnit
from workbench.project.named_designs import load_design

COMMANDS = {
    "run": (),
    "export": (),
    "sweep": ("--field", "design.shape.cut_mm", "--from", "1", "--to", "2"),
}


@pytest.fixture
def stl(tmp_path: Path) -> str:
    path = tmp_path / "brick.stl"
    trimesh.creation.box((30.0, 24.0, 20.0)).export(path)
    return str(path)


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_places_a_body_alike(command: str, stl: str) -> None:
    """A turn that begins with a minus sign, a cut, a unit and the accepted repair."""
    words = [command, stl, *COMMANDS[command], "--out", "o", "--unit", "mm", "--repair"]
    words += ["--body-turn-deg", "-90,0,15", "--body-cut-mm", "2.5"]
    options = parser().parse_args(_join_negative(words))
    design = placed_design(options, load_design(options.design))
    assert design.body is not None
    assert design.body.unit is LengthUnit.MM
    assert design.body.repair
    turns = {"turn_x_deg": -90.0, "turn_y_deg": 0.0, "turn_z_deg": 15.0}
    assert dict(design.shape) == {**turns, "cut_mm": 2.5}


def test_without_the_options_a_design_stays_as_it_is(stl: str) -> None:
    """A unit or an accepted repair of a design file is not taken back."""
    options = parser().parse_args(["run", stl, "--out", "o"])
    design = load_design(stl).replace("body.repair", True)
    assert placed_design(options, design) is design


@pytest.mark.parametrize(
    ("words", "at"),
    [
        (("--body-turn-deg", "90,0"), "--body-turn-deg"),
        (("--body-turn-deg", "a,b,c"), "--body-turn-deg"),
        (("--body-turn-deg", "nan,0,0"), "--body-turn-deg"),
    ],
)
def test_turns_that_are_none_are_refused(stl: str, words: tuple[str, ...], at: str) -> None:
    """Three finite angles, or a message that shows how to write them."""
    options = parser().parse_args(["run", stl, "--out", "o", *words])
    with pytest.raises(DesignError, match="expected three angles") as caught:
        placed_design(options, load_design(stl))
    assert caught.value.at == at


@pytest.mark.parametrize(
    "words",
    [("--repair",), ("--body-cut-mm", "1"), ("--unit", "mm"), ("--body-turn-deg", "0,0,0")],
)
def test_options_of_a_body_are_refused_without_one(words: tuple[str, ...]) -> None:
    """A finger has no file to repair: the option is named, not ignored."""
    options = parser().parse_args(["run", "finger", "--out", "o", *words])
    with pytest.raises(DesignError, match=f"{words[0]} is for a body from a file") as caught:
        placed_design(options, load_design("finger"))
    assert caught.value.at == words[0]
