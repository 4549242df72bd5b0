"""Every shell command of the tutorial runs, with the files that the tutorial gives."""

from __future__ import annotations

import csv
import json
import os
import re
import shlex
import signal
import subprocess
import sys
import time
import urllib.error
import urllib.request
from pathlib import Path

import pytest

from workbench.system.free_port import free_port

ROOT = Path(__file__).parents[2]
TUTORIAL = (ROOT / "docs" / "tutorial.md").read_text(encoding="utf-8")
LIMIT_S = 120


def blocks(language: str) -> list[str]:
    """Fenced blocks of a language."""
    return re.findall(rf"^```{language}\n(.*?)^```$", TUTORIAL, flags=re.MULTILINE | re.DOTALL)


def commands() -> list[list[str]]:
    """All commands in their order, as words."""
    return [shlex.split(line) for block in blocks("sh") for line in block.splitlines()]


def files(folder: Path) -> None:
    """Write the design files, whose first line says what they are called."""
    for block in blocks("toml"):
        name = block.splitlines()[0].removeprefix("# ")
        (folder / name).write_text(block, encoding="utf-8")


def environment() -> dict[str, str]:
    return {**os.environ, "PYTHONPATH": str(ROOT), "WORKBENCH_DEVICE": "cpu"}


def workbench(words: list[str], folder: Path) -> subprocess.CompletedProcess[str]:
    """Run a command as a user does, in a folder of the user's."""
    return subprocess.run(
        [sys.executable, "-m", "workbench.cli", *words],
        cwd=folder,
        env=environment(),
        capture_output=True,
        text=True,
        timeout=LIMIT_S,
        check=False,
    )


def opens(words: list[str], folder: Path) -> bool:
    """Whether a server answers; on a port of its own, and it is ended as by Ctrl-C."""
    port = str(free_port())
    words = [port if word == words[words.index("--port") + 1] else word for word in words]
    command = [sys.executable, "-m", "workbench.cli", *words]
    with subprocess.Popen(command, cwd=folder, env=environment()) as server:
        try:
            return _answers(f"http://127.0.0.1:{port}/healthz")
        finally:
            server.send_signal(signal.SIGINT)
            server.wait(30)


def _answers(url: str) -> bool:
    deadline = time.monotonic() + LIMIT_S
    while time.monotonic() < deadline:
        try:
            with urllib.request.urlopen(url, timeout=1) as answer:
                return answer.status == 200
        except (urllib.error.URLError, OSError):
            time.sleep(0.2)
    return False


@pytest.mark.slow
def test_every_command_of_the_tutorial_runs(tmp_path: Path) -> None:
    """In the order of the text: exit code 0, and what the text says is there afterwards.

    `make` needs a network to install; its targets are only looked up.
    """
    files(tmp_path)
    for program, *words in commands():
        if program == "make":
            found = subprocess.run(
                ["make", "-n", *words], cwd=ROOT, capture_output=True, check=False
            )
            assert found.returncode == 0, words
        elif words[0] == "serve":
            assert opens(words, tmp_path), words
        else:
            assert program == "workbench", program
            done = workbench(words, tmp_path)
            assert done.returncode == 0, (words, done.stderr)
    out = tmp_path / "out"
    forces = [
        json.loads((out / name / "summary.json").read_text())["contact"]["normal_N"]
        for name in ("thick", "thin")
    ]
    # A bonded wall is stiffer the thinner it is, as the tutorial says.
    assert 0.0 < forces[0] < forces[1]
    assert (out / "compared" / "comparison.html").is_file()
    assert (out / "thin" / "report.html").is_file()
    with (out / "wall" / "sweep.csv").open(encoding="utf-8") as table:
        rows = list(csv.DictReader(table))
    assert [float(row["elastomer_mm"]) for row in rows] == [1.5, 2.5]
    assert list((out / "parts").rglob("*.stl"))
