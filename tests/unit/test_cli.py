"""The command line: exit codes, one clear message, negative numbers as values."""

from __future__ import annotations

import json
import socket
from pathlib import Path

import pytest

from workbench.cli import main, parser, press_case


def run(tmp_path: Path, *words: str) -> int:
    return main([words[0], "--project", str(tmp_path / "p"), *words[1:]])


BAD = {
    "unknown preset": (["hand"], "design", "there is no preset"),
    "negative depth": (["geltip", "--depth-mm", "-1"], "press.depth_mm", "-1 mm"),
    "two numbers": (["geltip", "--target", "0,10"], "--target", "3 numbers"),
    "not numbers": (["geltip", "--target", "a,b,c"], "--target", "'a,b,c'"),
    "unknown indenter": (["geltip", "--indenter", "spere"], "indenter", "'spere'"),
    "no such file": (["geltip", "--indenter", "none.stl"], "indenter", "none.stl"),
    "size of zero": (["geltip", "--size-mm", "0"], "indenter.size_mm", "0 mm"),
    "no frames": (["geltip", "--frames", "0"], "press.frames", "0"),
    "fine grid": (["geltip", "--grid-mm", "0.001"], "contact.grid_mm", "0.001 mm"),
}


@pytest.mark.parametrize(("words", "at", "text"), BAD.values(), ids=BAD)
def test_bad_input_exits_2_with_value_and_remedy(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], words: list[str], at: str, text: str
) -> None:
    """Exit code 2; stderr has error, at and hint; nothing is written."""
    out = tmp_path / "out"
    assert run(tmp_path, "run", *words, "--out", str(out)) == 2
    message = capsys.readouterr().err
    assert text in message.splitlines()[0]
    assert f"at: {at}" in message
    assert "hint: " in message
    assert not out.exists()


def test_errors_are_json_when_asked(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """With --json the error is one JSON object on stdout."""
    assert run(tmp_path, "run", "hand", "--out", str(tmp_path), "--json") == 2
    error = json.loads(capsys.readouterr().out)
    assert error["error"] == "DesignError"
    assert error["at"] == "design"


def test_negative_coordinates_are_values() -> None:
    """`--target -3,0,35` and `--shear-mm -0.5,0` are read as numbers."""
    from workbench.cli import _join_negative

    words = ["run", "geltip", "--target", "-3,0,35", "--shear-mm", "-.5,0", "--out", "x"]
    case = press_case(parser().parse_args(_join_negative(words)))
    assert case.press.target_mm == (-3.0, 0.0, 35.0)
    assert case.press.shear_mm == (-0.5, 0.0)


def test_busy_port_exits_2(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A taken port is named with the command that uses the next one."""
    with socket.socket() as other:
        other.bind(("127.0.0.1", 0))
        other.listen()
        port = other.getsockname()[1]
        assert run(tmp_path, "serve", "--port", str(port)) == 2
    message = capsys.readouterr().err
    assert f"port {port} is taken" in message
    assert f"--port {port + 1}" in message


def test_unknown_room_exits_2(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The hint names the nearest room."""
    assert run(tmp_path, "validate", "contacts") == 2
    assert "'contact'" in capsys.readouterr().err


def test_presets_lists_presets_and_families(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """geltip is a preset and finger a family."""
    assert run(tmp_path, "presets", "--json") == 0
    rows = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    assert {"geltip": "preset", "finger": "family"}.items() <= {
        r["name"]: r["kind"] for r in rows
    }.items()


def test_bug_leaves_a_crash_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """An unforeseen exception exits 1 and keeps its traceback in the project."""

    def broken() -> None:
        raise ZeroDivisionError("bug")

    monkeypatch.setattr("workbench.project.presets", broken)
    assert run(tmp_path, "presets") == 1
    (crash,) = (tmp_path / "p" / "crash").iterdir()
    assert "ZeroDivisionError: bug" in crash.read_text()


def test_ctrl_c_exits_130(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """KeyboardInterrupt is a cancel, not a crash."""

    def interrupted() -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("workbench.project.presets", interrupted)
    assert run(tmp_path, "presets") == 130
    assert not (tmp_path / "p" / "crash").exists()
