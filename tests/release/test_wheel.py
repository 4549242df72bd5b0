"""The wheel holds every file that it needs, and works in a folder that holds nothing."""

from __future__ import annotations

import json
import signal
import socket
import subprocess
import time
import urllib.request
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from tests.release.conftest import ROOT, clean_environment, ran, tracked
from workbench.core.base.version import VERSION

START_S = 90.0
"""More than a busy machine of two cores takes to import the page and the scene."""
pytestmark = pytest.mark.slow


def test_it_holds_what_git_holds_and_nothing_else(held: set[str], wheel: Path) -> None:
    """Every file of the packages in git, and beside them only what says what the wheel is."""
    said = {name for name in held if name.split("/")[0].endswith(".dist-info")}
    files = set(tracked())
    assert len([name for name in files if not name.endswith(".py")]) > 50
    assert held - said == files
    assert {Path(name).name for name in said} >= {"LICENSE", "NOTICE", "METADATA"}
    assert wheel.name == f"sensor_workbench-{VERSION}-py3-none-any.whl"


def test_the_command_says_its_version_and_presets(installed: Path, tmp_path: Path) -> None:
    """Both from the wheel, in a folder that holds nothing."""
    command = installed / "workbench"
    assert ran([command, "--version"], tmp_path).strip() == VERSION
    there = {path.stem for path in (ROOT / "designs" / "presets").glob("*.toml")}
    rows = map(json.loads, ran([command, "presets", "--json"], tmp_path).splitlines())
    assert {row["name"] for row in rows if row["kind"] == "preset"} == there
    code = "import workbench; print(workbench.__file__)"
    where = Path(ran([installed / "python", "-c", code], tmp_path).strip())
    assert where.is_relative_to(installed.parent)


def test_a_press_is_computed_and_read_back(pressed: Path) -> None:
    """The whole chain of `make demo`, coarser: force and skin agree, and there are parts."""
    summary = json.loads((pressed / "press" / "summary.json").read_text(encoding="utf-8"))
    with np.load(pressed / "press" / "contact.npz") as contact:
        felt_N = -contact["contact_force_N"][-1].sum(axis=0, dtype=np.float64)
        np.testing.assert_allclose(felt_N, contact["reaction_N"][-1], atol=1e-4)
    assert np.linalg.norm(felt_N) == pytest.approx(summary["contact"]["normal_N"], rel=1e-2)
    assert summary["contact"]["normal_N"] > 0.05
    assert list((pressed / "press" / "moulds").glob("*.stl"))
    assert (pressed / "press" / "frame_000.png").stat().st_size > 1000


@pytest.fixture
def served(installed: Path, tmp_path: Path) -> Iterator[str]:
    """Address of a server that runs in an empty folder."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    command = [str(installed / "workbench"), "serve", "pad", "--port", str(port), "--no-tour"]
    with (tmp_path / "log").open("wb") as log:
        env = clean_environment()
        server = subprocess.Popen(command, cwd=tmp_path, env=env, stdout=log, stderr=log)
    try:
        yield f"http://127.0.0.1:{port}"
    finally:
        server.send_signal(signal.SIGTERM)
        server.wait(30)
    assert "Traceback" not in (tmp_path / "log").read_text(encoding="utf-8")


def test_it_serves_the_page(served: str) -> None:
    """`/healthz` answers, and the page is there with what a browser draws with."""
    until = time.monotonic() + START_S
    while True:
        try:
            with urllib.request.urlopen(f"{served}/healthz", timeout=5) as answer:
                assert answer.status == 200
            break
        except OSError:
            assert time.monotonic() < until, "it did not answer"
            time.sleep(0.3)
    with urllib.request.urlopen(served, timeout=20) as answer:
        page = answer.read()
    assert b"<html" in page and len(page) > 100_000
