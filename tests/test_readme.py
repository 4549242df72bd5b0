"""The README is one page, and what it shows works: its Python and its lines of shell."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from designs.family import families
from tests.pages import ROOT, blocks, commands
from workbench.pipeline.store import Store
from workbench.project.project import STORE_VARIABLE

README = (ROOT / "README.md").read_text(encoding="utf-8")
SHORTEST, LONGEST = 100, 150
LINES = 10
"""Lines that its examples have, about."""
LIMIT_S = 600
ELSEWHERE = ("serve", "fem", "sweep", "dataset")
"""A server does not end, the others take minutes: the tutorial's test and those of their own."""


def test_the_readme_is_one_page() -> None:
    """Between 100 and 150 lines, with one example in each language."""
    assert SHORTEST <= len(README.splitlines()) <= LONGEST
    assert [len(blocks(README, language)) for language in ("sh", "python")] == [1, 1]
    assert len(commands(README)) <= LINES
    (code,) = blocks(README, "python")
    assert len([line for line in code.splitlines() if line.strip()]) <= LINES


def test_what_the_readme_counts_is_there() -> None:
    """Seven families besides a body of one's own, and ten examples."""
    assert "seven families of membranes" in README
    assert len(families()) == 7 + 1
    assert "has ten programs" in README
    assert len(list((ROOT / "examples").glob("*.py"))) == 10


@pytest.fixture
def environment(tmp_path: Path, results: Store) -> dict[str, str]:
    """A project of a reader's own, whose results may be those of other tests."""
    places = {"PYTHONPATH": str(ROOT), "WORKBENCH_PROJECT": str(tmp_path / "project")}
    places[STORE_VARIABLE] = str(results.root)
    return {**os.environ, **places, "WORKBENCH_DEVICE": "cpu"}


@pytest.mark.slow
def test_the_python_of_the_readme_runs(tmp_path: Path, environment: dict[str, str]) -> None:
    """Arrays have the shapes that its comments state, and the folder what a run writes."""
    (code,) = blocks(README, "python")
    tell = (
        "import json\nprint(json.dumps([list(one.shape) for one in "
        "(points_mm, faces, moved_mm, force_N, rest, pressed)]))"
    )
    done = subprocess.run(
        [sys.executable, "-c", f"{code}\n{tell}"],
        cwd=tmp_path,
        env=environment,
        capture_output=True,
        text=True,
        timeout=LIMIT_S,
        check=False,
    )
    assert done.returncode == 0, done.stderr[-2000:]
    points, faces, moved, force, rest, pressed = json.loads(done.stdout.splitlines()[-1])
    assert (points[1], faces[1]) == (3, 3)
    assert (moved, force) == ([3, points[0], 3], [3, 3])
    assert rest == pressed == [480, 640, 3]
    written = json.loads((tmp_path / "out" / "python" / "summary.json").read_text())
    with np.load(tmp_path / "out" / "python" / "contact.npz") as contact:
        assert contact["displacement_mm"].shape == tuple(moved)
    assert written["contact"]["normal_N"] > 0.0


@pytest.mark.slow
def test_the_shell_of_the_readme_runs(tmp_path: Path, environment: dict[str, str]) -> None:
    """In the order of the text: exit code 0, and each folder that is named is there."""
    for words in commands(README):
        if words[0] in ELSEWHERE:
            continue
        done = subprocess.run(
            [sys.executable, "-m", "workbench.cli", *words],
            cwd=tmp_path,
            env=environment,
            capture_output=True,
            text=True,
            timeout=LIMIT_S,
            check=False,
        )
        assert done.returncode == 0, (words, done.stderr[-2000:])
        if "--out" in words:
            assert any((tmp_path / words[words.index("--out") + 1]).iterdir()), words
