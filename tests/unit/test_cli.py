"""The command line: exit codes, one clear message, negative numbers as values."""

from __future__ import annotations

import errno
import json
import os
import re
import signal
import socket
import subprocess
import sys
import tomllib
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from workbench.cli import bench_rooms as bench
from workbench.cli import diagnosis as doctor
from workbench.cli import validate_rooms as validate
from workbench.cli.command_line import main, parser
from workbench.cli.press_options import press_case
from workbench.core.base.errors import DesignError, SolveError
from workbench.core.design.design import Law, SensorDesign
from workbench.core.press.press import ContactSettings, Extent, Method, Press
from workbench.core.press.press_case import PressCase
from workbench.core.press.trajectory import unit_pose
from workbench.project.design_toml import design_to_toml
from workbench.project.named_designs import load_design
from workbench.proof.benchmarks.pipeline import rerun_row
from workbench.proof.row import Row, as_json, as_text, bounded, compared, failed
from workbench.report import outputs


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
    "loose region": (["geltip", "--region-error", "2"], "contact.region_error", "2"),
    "no sequence": (["geltip", "--sequence", "grip"], "--sequence", "'grip'"),
    "misspelt sequence": (["trunk", "--sequence", "gripp"], "--sequence", "'gripp'"),
    "two paths": (["trunk", "--sequence", "grip", "--twist-deg", "9"], "--twist-deg", "grip"),
    "pose of six": (["geltip", "--object-pose", "0,0,0,1,0,0"], "--object-pose", "7 numbers"),
}
GRIP, TIMED = ("trunk", "--sequence", "grip"), ("geltip", "--trajectory", "path.csv")
BAD |= {
    f"{path[1]} {option}": ([*path, option, value], option, f"{option} is given with {path[1]}")
    for path, options in (
        (GRIP, {"--mover": "sensor", "--every-s": "1", "--twist-deg": "0", "--stroke": "hold"}),
        (TIMED, {"--depth-mm": "1", "--shear-mm": "0,0", "--twist-deg": "5", "--frames": "3"}),
        (TIMED, {"--target": "0,0,0"}),
        ((*TIMED, "--mover", "sensor", "--object-pose", "0,0,9,1,0,0,0"), {"--target": "0,0,0"}),
    )
    for option, value in options.items()
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
    from workbench.cli.command_line import _join_negative

    words = ["run", "geltip", "--target", "-3,0,35", "--shear-mm", "-.5,0", "--out", "x"]
    options = parser().parse_args(_join_negative(words))
    case = press_case(options, load_design("geltip"), (0.0, 0.0, 0.0))
    assert case.press.target_mm == (-3.0, 0.0, 35.0)
    assert case.press.shear_mm == (-0.5, 0.0)


def test_a_moving_sensor_needs_a_target(tmp_path: Path) -> None:
    """Of a trajectory of the sensor the target says where the object stands: it is taken."""
    path = tmp_path / "path.csv"
    path.write_text("t_s,x_mm,y_mm,z_mm,qw,qx,qy,qz\n0,0,0,0,1,0,0,0\n1,0,0,1,1,0,0,0\n")
    words = ["run", "geltip", "--trajectory", str(path), "--mover", "sensor"]
    options = parser().parse_args([*words, "--target", "0,0,45", "--out", "x"])
    press = press_case(options, load_design("geltip"), (0.0, 0.0, 0.0)).press
    assert (press.target_mm, press.mover) == ((0.0, 0.0, 45.0), "sensor")
    assert press.trajectory is not None and press.trajectory.every_s == 0.0


def test_the_example_of_a_message_is_valid(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """What the hint of --object-pose, --target and --shear-mm suggests is taken as typed."""
    words = ["geltip", "--out", str(tmp_path / "out")]
    for option in ("--object-pose", "--target", "--shear-mm"):
        assert run(tmp_path, "run", *words, f"{option}=a") == 2
        message = capsys.readouterr().err
        (example,) = re.findall(rf"for example {option} (\S+)", message)
        assert "in mm" in message
        plain = parser().parse_args(["run", *words, option, example])
        at = (0.0, 0.0, 0.0)
        if option == "--object-pose":
            pose = unit_pose([float(part) for part in example.split(",")], what="pose")
            assert len(pose) == 7
        else:
            assert press_case(plain, load_design("geltip"), at).press.target_mm is not None


def test_solver_options_are_fields_of_the_settings() -> None:
    """Each option sets the field of its name; what is left out keeps its default."""
    words = "run geltip --extent full --method particles --region-error 0.01 --max-substeps 50"
    words += " --tolerance 0.002 --penalty 60 --grid-mm 0.7 --material-law linear --out x"
    options = parser().parse_args(words.split())
    case = press_case(options, load_design("geltip"), (0.0, 0.0, 0.0))
    assert case.settings == ContactSettings(
        extent=Extent.FULL,
        method=Method.PARTICLES,
        region_error=0.01,
        max_substeps=50,
        tolerance=0.002,
        penalty=60.0,
        grid_mm=0.7,
    )
    assert Law(options.material_law) is Law.LINEAR
    plain = parser().parse_args("run geltip --out x".split())
    bare = press_case(plain, load_design("geltip"), (0.0, 10.0, 35.0))
    assert (bare.settings, bare.press) == (ContactSettings(), Press())


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

    monkeypatch.setattr("workbench.project.named_designs.presets", broken)
    assert run(tmp_path, "presets") == 1
    (crash,) = (tmp_path / "p" / "crash").iterdir()
    assert "ZeroDivisionError: bug" in crash.read_text()


def test_ctrl_c_exits_130(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """KeyboardInterrupt is a cancel, not a crash."""

    def interrupted() -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("workbench.project.named_designs.presets", interrupted)
    assert run(tmp_path, "presets") == 130
    assert not (tmp_path / "p" / "crash").exists()


def test_crash_file_that_cannot_be_written_keeps_the_traceback(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """With a project folder that is a file the bug itself is still what one reads."""

    def broken() -> None:
        raise ZeroDivisionError("bug")

    (tmp_path / "p").write_text("a file")
    monkeypatch.setattr("workbench.project.named_designs.presets", broken)
    assert run(tmp_path, "presets") == 1
    assert "ZeroDivisionError: bug" in capsys.readouterr().err


@pytest.mark.parametrize(
    "problem", [MemoryError(), OSError(errno.ENOSPC, "No space left on device")], ids=repr
)
def test_full_memory_and_disk_exit_3(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    problem: Exception,
) -> None:
    """Neither is a bug: one message, exit code 3, no crash file."""

    def exhausted() -> None:
        raise problem

    monkeypatch.setattr("workbench.project.named_designs.presets", exhausted)
    assert run(tmp_path, "presets") == 3
    assert capsys.readouterr().err.startswith("error: ")
    assert not (tmp_path / "p" / "crash").exists()


def test_termination_exits_130(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """SIGTERM is Ctrl-C, and the handler of before is back afterwards."""
    before = signal.getsignal(signal.SIGTERM)
    monkeypatch.setattr(
        "workbench.project.named_designs.presets", lambda: signal.raise_signal(signal.SIGTERM)
    )
    assert run(tmp_path, "presets") == 130
    assert signal.getsignal(signal.SIGTERM) is before


@pytest.mark.parametrize("ok", [True, False])
def test_closed_reader_changes_no_exit_code(tmp_path: Path, ok: bool) -> None:
    """Rows printed to a closed pipe still exit 0 or 1, and Python adds no complaint at exit."""
    code = (
        "import sys, workbench.cli.validate_rooms; from workbench.cli import main;"
        "from workbench.proof.row import bounded;"
        f"row = bounded('r', 'c', {0 if ok else 2}.0, unit='1', limit=1.0);"
        "workbench.cli.validate_rooms.ROOMS['one'] = lambda: [row];"
        f"sys.exit(main(['validate', '--project', {str(tmp_path)!r}, 'one', '--json']))"
    )
    reader, writer = os.pipe()
    os.close(reader)
    try:
        command = [sys.executable, "-c", code]
        done = subprocess.run(
            command, stdout=writer, stderr=subprocess.PIPE, text=True, check=False
        )
    finally:
        os.close(writer)
    assert (done.returncode, done.stderr) == (0 if ok else 1, "")


def test_output_folder_is_probed_before_anything_is_computed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """A file in the way exits 2, a folder below a file exits 3; no stage has begun."""

    def computed(*args: object, **keywords: object) -> None:
        raise AssertionError("a stage ran")

    monkeypatch.setattr("workbench.planning.plan.evaluate", computed)
    file = tmp_path / "file"
    file.write_text("mine")
    assert run(tmp_path, "run", "geltip", "--out", str(file)) == 2
    assert "is a file" in capsys.readouterr().err
    assert run(tmp_path, "run", "geltip", "--out", str(file / "out")) == 3
    assert "cannot write" in capsys.readouterr().err
    assert file.read_text() == "mine"


def test_failed_run_leaves_nothing_of_an_earlier_one(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """After exit 3 the folder holds what is not ours; no image, number, part, nor the probe."""

    def unsettled(*args: object, **keywords: object) -> None:
        raise SolveError("did not settle")

    monkeypatch.setattr("workbench.planning.plan.evaluate", unsettled)
    out = tmp_path / "out"
    (out / "moulds").mkdir(parents=True)
    old = ("summary.json", "report.html", "frame_003.png", "contact_003.vtp", "contact.npz")
    for name in (*old, "forces.csv", "slip.csv", "moulds/half_a.stl", "moulds/mine.txt", "my.png"):
        (out / name).write_text("old")
    assert run(tmp_path, "run", "geltip", "--out", str(out)) == 3
    left = [str(path.relative_to(out)) for path in out.rglob("*") if path.is_file()]
    assert sorted(left) == ["moulds/mine.txt", "my.png"]


def test_parts_of_another_mould_are_removed(tmp_path: Path) -> None:
    """moulds/ holds the files of this run and what is not ours, nothing of the one before."""
    moulds = tmp_path / "moulds"
    moulds.mkdir()
    for name in ("old.stl", "old.step", "mine.txt"):
        (moulds / name).write_text("old")
    bundle = SimpleNamespace(files={"moulds/half_a.stl": np.zeros(3, np.uint8)})
    outputs.write_package(tmp_path, bundle)  # type: ignore[arg-type]
    assert sorted(path.name for path in moulds.iterdir()) == ["half_a.stl", "mine.txt"]


def unmeasurable() -> float:
    raise SolveError("did not settle")


def test_row_that_cannot_be_measured_fails_alone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Value null and ok false for it, the other row as measured, valid JSON, exit 1."""
    rows = [
        compared("a", "x", unmeasurable, 1.0, unit="N", limit=0.1),
        bounded("b", "x", unmeasurable, unit="N", limit=0.1),
        compared("c", "x", lambda: 1.05, lambda: 1.0, unit="N", limit=0.1),
    ]
    monkeypatch.setitem(validate.ROOMS, "fem", lambda: rows)
    assert run(tmp_path, "validate", "fem", "--json") == 1
    printed = json.loads(capsys.readouterr().out)
    assert [(row["value"], row["ok"]) for row in printed] == [
        (None, False),
        (None, False),
        (1.05, True),
    ]
    assert all("did not settle" in row["case"] for row in printed[:2])
    assert run(tmp_path, "validate", "fem") == 1


def test_several_rooms_are_measured_one_after_the_other(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Rows in the order asked, one list; a record is of one room, and a room that is none is told
    before any is measured."""
    for room, value in (("fem", 1.0), ("optics", 2.0)):
        row = bounded("gain", room, value, unit="1", limit=1.5)
        monkeypatch.setitem(validate.ROOMS, room, lambda row=row: [row])
    assert run(tmp_path, "validate", "optics", "fem", "--json") == 1
    said = capsys.readouterr()
    rows = json.loads(said.out)
    assert [(row["case"], row["ok"]) for row in rows] == [("optics", False), ("fem", True)]
    assert all(row["against"] for row in rows)
    assert "1 of 2: optics: 1 rows, 1 not ok" in said.err
    assert run(tmp_path, "validate", "fem", "optics", "--record", str(tmp_path / "x")) == 2
    assert run(tmp_path, "validate", "fem", "optic") == 2
    assert "optics" in capsys.readouterr().err


def test_rows_are_told_as_they_are_measured(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Rooms take minutes: each row has its line beside the answer, before the next one starts."""
    heard: list[str] = []

    def measured() -> float:
        heard.append(capsys.readouterr().err)
        return 2.0

    monkeypatch.setitem(
        validate.ROOMS,
        "fem",
        lambda: [bounded(n, "x", measured, unit="N", limit=3.0 - k) for k, n in enumerate("abc")],
    )
    assert run(tmp_path, "validate", "fem", "--json") == 1
    said = capsys.readouterr()
    assert heard[0] == ""
    assert heard[1].startswith("ok   a after")
    assert said.err.startswith("FAIL c after")
    assert len(json.loads(said.out)) == 3


@pytest.mark.parametrize("command", ["validate", "bench"])
def test_room_that_cannot_begin_is_a_failed_row(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    command: str,
) -> None:
    """Still a JSON list, with one row that is not ok."""
    rooms = {"validate": validate.ROOMS, "bench": bench.ROOMS}[command]
    monkeypatch.setitem(rooms, "contact", unmeasurable)
    assert run(tmp_path, command, "contact", "--json") == 1
    (row,) = json.loads(capsys.readouterr().out)
    assert (row["name"], row["value"], row["ok"]) == ("contact", None, False)


@pytest.mark.parametrize("show", [as_json, as_text])
def test_rows_are_told_apart_by_name_and_case(show: object) -> None:
    """Two rows of one name and case are refused."""
    with pytest.raises(ValueError, match="same name and case"):
        show([failed("a", "x"), failed("a", "x")])  # type: ignore[operator]


@pytest.mark.parametrize(
    ("redone", "ok"), [(["shoot"], True), (["press"], False), ([], False), (["press", "shoot"], 0)]
)
def test_camera_move_may_rerun_shoot_only(redone: list[str], ok: bool) -> None:
    """One other stage, none, or two do not pass; the case never changes."""
    cached = {stage: stage not in redone for stage in ("build", "press", "shoot")}
    row: Row = rerun_row(lambda: cached)
    assert row.ok is bool(ok)
    assert row.case == rerun_row(lambda: {}).case
    assert row.value == len(redone)


def test_doctor_knows_every_dependency() -> None:
    """What pyproject.toml requires is in one of doctor's lists."""
    text = (Path(__file__).parents[2] / "pyproject.toml").read_text()
    wanted = {
        line.split(">")[0].split("=")[0] for line in tomllib.loads(text)["project"]["dependencies"]
    }
    assert wanted <= {*doctor.REQUIRED, *doctor.OPTIONAL}


def test_doctor_finds_an_unusable_project(tmp_path: Path) -> None:
    """A file, and a folder below a file, are not healthy; a folder that can be made is."""
    file = tmp_path / "file"
    file.write_text("")
    assert doctor.report(tmp_path / "new" / "project")[1]
    for project in (file, file / "below"):
        lines, healthy = doctor.report(project)
        assert not healthy
        assert any(doctor.UNUSABLE in line for line in lines)


def test_doctor_reports_a_missing_device(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """WORKBENCH_DEVICE=cuda without one is a line of the report, exit 3."""
    monkeypatch.setenv("WORKBENCH_DEVICE", "cuda")
    monkeypatch.setattr("workbench.pipeline.devices.cuda_count", lambda: 0)
    assert run(tmp_path, "doctor") == 3
    printed = capsys.readouterr().out
    assert "0 CUDA devices" in printed
    assert "viser" in printed


def test_summary_names_the_device_that_computed(monkeypatch: pytest.MonkeyPatch) -> None:
    """A contact stored by a GPU is not called a CPU result on another day."""
    contact: Any = SimpleNamespace(device="cuda")
    shot: Any = SimpleNamespace(metrics=SimpleNamespace(values={}))
    monkeypatch.setenv("WORKBENCH_DEVICE", "cpu")
    monkeypatch.setattr(outputs, "contact_summary", lambda *args: {})
    monkeypatch.setattr(outputs, "press_summary", lambda *args: {})
    design = SensorDesign(name="n", family="f")
    summary = outputs.summary_table(design, PressCase(), contact, shot, 1.0, [])
    assert summary["device"] == "cuda"


def test_solver_import_prints_nothing_into_the_answer(tmp_path: Path) -> None:
    """A room that imports Taichi before it opens a device still prints JSON and nothing else."""
    command = f"'validate', '--project', {str(tmp_path)!r}"
    # The first call fails, but makes the rooms known: they may import Taichi themselves.
    code = (
        f"import sys; from workbench.cli import main; main([{command}, 'no such room']);"
        "import workbench.cli.validate_rooms;"
        "workbench.cli.validate_rooms.ROOMS['one'] = lambda: __import__('taichi') and [];"
        f"sys.exit(main([{command}, 'one', '--json']))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert json.loads(done.stdout) == []


def test_a_failed_export_leaves_nothing_of_an_earlier_one(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Parts, pictures and reports of another design go; the design that is asked for, the bodies it
    names and what is not ours stay.
    """

    def refused(*args: object, **keywords: object) -> None:
        raise DesignError("no body")

    monkeypatch.setattr("workbench.planning.plan.evaluate", refused)
    out = tmp_path / "out"
    old = ("moulds/core.stl", "parts/support.step", "recipe.json", "report.html", "membrane.stl")
    mine = ("bodies/0.stl", "mine.txt")
    for name in (*old, *mine):
        (out / name).parent.mkdir(parents=True, exist_ok=True)
        (out / name).write_text("old")
    (out / "design.toml").write_text(design_to_toml(SensorDesign(name="mine")))
    assert run(tmp_path, "export", str(out / "design.toml"), "--out", str(out)) == 2
    assert not [name for name in old if (out / name).exists()]
    assert all((out / name).exists() for name in (*mine, "design.toml"))


def test_export_asks_where_to(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Neither a folder for files nor one for a pack: refused before anything is built."""
    assert run(tmp_path, "export", "finger") == 2
    said = capsys.readouterr().err
    assert "nothing says where the files go" in said
    assert "--pack DIR" in said
