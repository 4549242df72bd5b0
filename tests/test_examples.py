"""Every example runs as it stands, is short, says what it shows, and asserts what it found."""

from __future__ import annotations

import ast
import os
import subprocess
import sys
from pathlib import Path

import pytest

from workbench.pipeline.store import Store
from workbench.project.project import STORE_VARIABLE

FOLDER = Path(__file__).parent.parent / "examples"
EXAMPLES = sorted(FOLDER.glob("*.py"))
SHORTEST, LONGEST = 25, 75


@pytest.fixture(scope="module")
def workplace(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder of a user's own, in which the examples find each other's results."""
    return tmp_path_factory.mktemp("examples")


def test_there_are_eight_or_more() -> None:
    """Numbered in the order of reading, and the one that goes through all stages."""
    assert len([path for path in EXAMPLES if path.stem[:2].isdigit()]) >= 8
    assert FOLDER / "slider_to_pixel.py" in EXAMPLES


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_an_example_is_short_and_says_what_it_shows(path: Path) -> None:
    """A title, what it shows, and asserts at its end."""
    text = path.read_text()
    assert SHORTEST <= len(text.splitlines()) <= LONGEST
    tree = ast.parse(text)
    told = ast.get_docstring(tree) or ""
    assert told.splitlines()[0].endswith(".")
    assert "\nShows: " in told
    assert any(isinstance(node, ast.Assert) for node in tree.body) or "np.testing" in text


@pytest.mark.slow
@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_an_example_runs(path: Path, workplace: Path, results: Store) -> None:
    """In a process of its own, away from the repository; its own asserts are the test."""
    if "\nimport mujoco\n" in path.read_text():
        pytest.importorskip("mujoco")
    places = {"WORKBENCH_PROJECT": str(workplace / "project"), STORE_VARIABLE: str(results.root)}
    done = subprocess.run(
        [sys.executable, str(path)],
        cwd=workplace,
        env={**os.environ, **places},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr[-2000:]


def test_examples_use_the_front_door_alone() -> None:
    """But for the one that opens the stages, they import nothing else of ours."""
    ours = {"workbench", "designs", "geometry", "sim", "ui"}
    for path in EXAMPLES:
        if path.stem == "slider_to_pixel":
            continue
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.ImportFrom):
                assert (node.module or "").split(".")[0] not in ours, path
            elif isinstance(node, ast.Import):
                names = {alias.name for alias in node.names}
                assert not {name for name in names if name.split(".")[0] in ours} - {"workbench"}
