"""One coarse design and one project store for the tests of the whole command."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from workbench.cli.command_line import main
from workbench.pipeline.store import Store
from workbench.project.project import STORE_VARIABLE

COARSE = """\
schema = 1
name = "coarse"
family = "finger"
[shape]
outer_radius_mm = 8.0
cylinder_mm = 8.0
[meshing]
hex_mm = 0.8
[housing]
camera_width_mm = 2.4
camera_height_mm = 2.4
camera_depth_mm = 3.0
led_width_mm = 1.2
led_height_mm = 1.0
wall_mm = 0.9
[optics.baking]
photons = 200000
nodes = 1000
[optics.ring]
radius_mm = 3.0
[optics.camera]
width_px = 160
height_px = 120
"""
"""A small finger whose whole chain takes about 10 s; its tip is at z = 16 mm, and camera and LEDs
are small enough for its cavity."""


@dataclass(frozen=True, kw_only=True)
class Finished:
    """What a command left: exit code, JSON lines of stdout, text of stderr."""

    code: int
    lines: list[dict[str, Any]]
    stderr: str

    def keys(self) -> dict[str, str]:
        """Key of each stage that ran or was found."""
        return {line["stage"]: line["key"] for line in self.lines if "key" in line}

    def computed(self) -> list[str]:
        """Stages that were not found in the store."""
        return [line["stage"] for line in self.lines if line.get("cached") is False]


Command = Callable[..., Finished]


@pytest.fixture(scope="module")
def project(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A project folder shared by the tests of a module, so that a stage is computed once."""
    return tmp_path_factory.mktemp("project")


@pytest.fixture(scope="module")
def shared_results(results: Store) -> Iterator[None]:
    """Commands find what other modules have computed: for those that look at what comes out."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv(STORE_VARIABLE, str(results.root))
        yield


@pytest.fixture
def workbench(project: Path, capsys: pytest.CaptureFixture[str]) -> Command:
    """A function that runs a command with `--json` in the shared project."""

    def run(*words: Any) -> Finished:
        capsys.readouterr()
        code = main([str(word) for word in (*words, "--project", project, "--json")])
        said = capsys.readouterr()
        lines = [json.loads(line) for line in said.out.splitlines()]
        return Finished(code=code, lines=lines, stderr=said.err)

    return run


@pytest.fixture(scope="module")
def coarse(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The coarse design as a file."""
    path = tmp_path_factory.mktemp("design") / "coarse.toml"
    path.write_text(COARSE)
    return path
