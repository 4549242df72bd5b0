"""Messages about values of 100 KB stay readable: 80 characters of the value, wherever it stood."""

from __future__ import annotations

import dataclasses
import typing
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from workbench.cli.command_line import main
from workbench.core.base.errors import DesignError, GeometryError, shown
from workbench.core.base.mapping import from_table
from workbench.core.design.design import SensorDesign
from workbench.core.press.press_case import PressCase

LONG = "x" * 100_000
LONGEST_LINE = 600
"""Characters that no message needs: the longest without a value has 300."""


@pytest.mark.parametrize(("value", "kept"), [("short", "'short'"), ([1, 2], "[1, 2]")])
def test_a_short_value_is_shown_whole(value: object, kept: str) -> None:
    """As Python writes it."""
    assert shown(value) == kept


def test_a_long_value_keeps_both_ends() -> None:
    """80 characters: 50 of the head, three dots, 27 of the tail, which tells paths apart."""
    text = shown("/folder/" * 100 + "idle.png")
    assert len(text) == 80
    assert text.startswith("'/folder/")
    assert text.endswith("/idle.png'")


@pytest.mark.parametrize("path", [f"{LONG}.toml", f"{'folder/' * 20_000}x.toml"])
@pytest.mark.parametrize("command", ["run", "export"])
def test_a_path_that_no_disk_takes_is_cut(
    command: str, path: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """As the design, and as the folder of the results."""
    project = ["--project", str(tmp_path / "p")]
    assert main([command, path, *project, "--out", str(tmp_path / "out")]) in (2, 3)
    assert main([command, "geltip", *project, "--out", f"{tmp_path}/{path}"]) in (2, 3)
    captured = capsys.readouterr()
    assert max(map(len, (captured.out + captured.err).splitlines())) < LONGEST_LINE


def test_where_is_cut_too() -> None:
    """A misspelt field of 100 KB."""
    assert len(GeometryError("no", at=f"shape.{LONG}").at) == 80


def fields_of(cls: Any, at: str = "") -> Iterator[str]:
    """Dotted names of every field of a dataclass and of those in it."""
    hints = typing.get_type_hints(cls)
    for field in dataclasses.fields(cls):
        yield f"{at}{field.name}"
        hint = hints[field.name]
        for part in (hint, *typing.get_args(hint)):
            if dataclasses.is_dataclass(part):
                yield from fields_of(part, f"{at}{field.name}.")


@pytest.mark.parametrize("cls", [SensorDesign, PressCase])
@pytest.mark.parametrize(
    "value", [LONG, [LONG], {LONG: LONG}, [1.0] * 50_000, 10**4000], ids=lambda v: type(v).__name__
)
def test_no_field_echoes_a_long_value(cls: Any, value: Any) -> None:
    """Every field of a design and of a press: accepted, or refused in a few lines."""
    for dotted in fields_of(cls):
        table: Any = value
        for name in reversed(dotted.split(".")):
            table = {name: table}
        try:
            from_table(cls, table)
        except DesignError as error:
            assert len(f"{error.message}{error.hint}{error.at}") < LONGEST_LINE, dotted


@pytest.mark.parametrize(
    "words",
    [
        ["--frames", LONG],
        ["--target", LONG],
        ["--indenter", LONG],
        ["--stroke", LONG],
        ["--texture", LONG],
        ["--sequence", LONG],
        ["--light-model", LONG],
        ["--trajectory", LONG],
        ["--sources", LONG],
        ["--sources", "learned", "--weights", LONG],
        ["--object-pose", LONG],
    ],
    ids=lambda words: words[0],
)
def test_no_option_echoes_a_long_value(
    words: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Exit 2, or 3 of weights that cannot be read, and no line of more than 600 characters."""
    common = ["--out", str(tmp_path / "out"), "--project", str(tmp_path / "project")]
    try:
        code = main(["run", "geltip", *common, *words])
    except SystemExit as end:
        code = int(end.code or 0)
    lines = capsys.readouterr().err.splitlines()
    assert code in (2, 3), lines[:3]
    assert max(map(len, lines)) < LONGEST_LINE
