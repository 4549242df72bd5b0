"""The README is kept honest: every command, option and file key it must name is in it."""

from __future__ import annotations

import argparse
import re
from pathlib import Path

import pytest

from workbench.cli import parser
from workbench.project import presets

ROOT = Path(__file__).parent.parent
README = (ROOT / "README.md").read_text()
KEYS = (
    "schema design family device stages stage key cached seconds contact reaction_N normal_N "
    "residual penetration_mm particles grid_mm substeps images moulds file watertight volume_mm3 "
    "metrics surface_points_mm surface_faces displacement_mm indenter_pose background.png "
    "frame_000.png contact.npz report.html summary.json"
).split()


def commands() -> dict[str, argparse.ArgumentParser]:
    (action,) = [a for a in parser()._actions if isinstance(a, argparse._SubParsersAction)]
    return dict(action.choices)


@pytest.mark.parametrize("name", commands())
def test_every_command_is_documented(name: str) -> None:
    """`workbench NAME` stands in the README."""
    assert f"workbench {name}" in README


def test_every_option_of_run_is_documented() -> None:
    """Each long option of `run` has a row."""
    for action in commands()["run"]._actions:
        for option in action.option_strings:
            if option.startswith("--") and option != "--help":
                assert option in README, option


@pytest.mark.parametrize("key", KEYS)
def test_every_contract_key_is_documented(key: str) -> None:
    """Other tools read these names."""
    assert key in README


def test_links_lead_somewhere() -> None:
    """Every relative link of the README names a file of the repository."""
    for target in re.findall(r"\]\(([^)#:]+)\)", README):
        assert (ROOT / target).exists(), target


def test_presets_open_with_their_purpose() -> None:
    """The first line of a preset says what it is."""
    assert all(len(purpose) > 20 for purpose in presets().values())


@pytest.mark.parametrize("package", ["workbench", "designs", "geometry", "sim", "ui"])
def test_every_package_has_its_design_note(package: str) -> None:
    """One short DESIGN.md per package."""
    assert len((ROOT / package / "DESIGN.md").read_text().splitlines()) < 60
