"""The README is kept honest: every command, option, room and file key is in it."""

from __future__ import annotations

import argparse
import dataclasses
import importlib
import inspect
import re
from pathlib import Path
from typing import Any

import pytest

from sim.optics.maps import measure
from workbench.cli import parser
from workbench.core.camera import Camera, ImageSensor, LensModel
from workbench.core.lighting import Baking, Lamp, LampKind, LedMount, LedRing, LightModel
from workbench.core.optics import Coating, MarkerPattern, Markers, Optics
from workbench.design_toml import design_from_toml
from workbench.named_designs import presets
from workbench.photos import shipped_photos

ROOT = Path(__file__).parent.parent
README = (ROOT / "README.md").read_text()
KEYS = (
    "schema design family device stages stage key cached seconds contact reaction_N normal_N "
    "residual penetration_mm particles grid_mm substeps images moulds file watertight volume_mm3 "
    "metrics surface_points_mm surface_faces displacement_mm indenter_pose background.png "
    "frame_000.png contact.npz report.html summary.json "
    "forces.csv slip.csv poses.csv failed settled von_mises_MPa cauchy_MPa contact_force_N "
    "light_model press maps difference_000.png motion_000.png markers.csv frames.npz maps.npz "
    "name case value unit reference null ceiling error error_kind limit sense ok"
).split()
PROSE = re.sub(r"^```.*?^```$", "", README, flags=re.MULTILINE | re.DOTALL)
CODE = " ".join(re.findall(r"`([^`]+)`", PROSE))
"""All that stands between single backticks; the tables of keys and options are among it."""


def commands() -> dict[str, argparse.ArgumentParser]:
    return {name: found for name, found in below(parser()).items() if not below(found)}


def below(top: argparse.ArgumentParser) -> dict[str, argparse.ArgumentParser]:
    """Every command of a parser, those of a group by both words, and the groups themselves."""
    found: dict[str, argparse.ArgumentParser] = {}
    for action in top._actions:
        if isinstance(action, argparse._SubParsersAction):
            for name, sub in action.choices.items():
                inner = {f"{name} {word}": command for word, command in below(sub).items()}
                found |= {name: sub, **inner}
    return found


def command_row(name: str) -> str:
    """The row of a command in the README's table."""
    (row,) = re.findall(rf"^\| `workbench {name}\b.*$", README, flags=re.MULTILINE)
    return row


def section(title: str) -> str:
    """The text under a heading, up to the next one."""
    return re.split(r"^#+ ", README.split(f"# {title}\n")[1], flags=re.MULTILINE)[0]


@pytest.mark.parametrize("name", commands())
def test_every_option_of_every_command_is_documented(name: str) -> None:
    """Each long option stands in the command's row, those of the press in the table of `run`."""
    pressing = ("run", "sweep", "fem solve", "fem export")
    text = command_row(name) + (section("`workbench run`") if name in pressing else "")
    documented = set(re.findall(r"(?<![\w-])--[a-z-]+", text)) | {"--help", "--project"}
    options = {o for a in commands()[name]._actions for o in a.option_strings if o[:2] == "--"}
    assert options <= documented, options - documented


def test_the_project_folder_is_documented_once_for_all_commands() -> None:
    """Every command takes `--project DIR`."""
    assert "--project DIR" in CODE
    assert all("--project" in c.format_help() for c in commands().values())


@pytest.mark.parametrize("name", ["validate", "bench"])
def test_every_room_is_documented(name: str) -> None:
    """The row of the command lists exactly the rooms there are."""
    rooms = importlib.import_module(f"workbench.{name}").ROOMS
    code = re.findall(r"`([^`]+)`", command_row(name))[1:]
    assert " ".join(code).split() == list(rooms)


@pytest.mark.parametrize("key", KEYS)
def test_every_contract_key_is_documented(key: str) -> None:
    """Other tools read these names: each stands in the README as code, a whole word."""
    assert key in re.findall(r"[\w.]+", CODE)


@pytest.mark.parametrize("part", [Camera, ImageSensor, LedRing, Lamp, Coating, Markers, Baking])
def test_every_field_of_the_optics_is_documented(part: Any) -> None:
    """A designer finds each field that a design file may hold."""
    fields = {item.name for item in dataclasses.fields(part)}
    # The table of the image sensor has a name of its own: `[optics.camera.sensor]`.
    assert fields - {"sensor"} <= set(re.findall(r"\w+", CODE)), part


@pytest.mark.parametrize("choice", [LightModel, LensModel, LampKind, LedMount, MarkerPattern])
def test_every_choice_of_the_optics_is_documented(choice: Any) -> None:
    """Each light model, lens, form of a lamp, mount and pattern stands in the README as code."""
    assert {member.value for member in choice} <= set(re.findall(r"\w+", CODE))


def test_every_shipped_photograph_is_documented() -> None:
    """Each is written as a design names it."""
    assert {f"builtin:{name}" for name in shipped_photos()} <= set(CODE.split())


def test_every_map_and_its_score_are_documented() -> None:
    """Names as the maps' source gives them; single lights are numbered there."""
    found = re.findall(r'name=f?"([\w.{}:]+)"', inspect.getsource(measure))
    names = {name.replace("{number:02d}", "01") for name in found}
    assert len(names) == 20
    assert names <= set(re.findall(r"[\w.]+", CODE)), names


def test_the_example_of_optics_is_a_design() -> None:
    """Two cameras, 6 LEDs and a line of 9 points over a photograph, as the README writes it."""
    blocks = re.findall(r"^```toml\n(\[optics\].*?)^```$", README, flags=re.MULTILINE | re.DOTALL)
    (optics,) = (design_from_toml(block).optics for block in blocks)
    assert isinstance(optics, Optics) and optics.background is not None
    assert (len(optics.all_cameras), optics.lights) == (2, 15)


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


def test_every_file_of_the_front_is_in_its_design_note() -> None:
    """`ui/DESIGN.md` names each file with its idea."""
    note = (ROOT / "ui" / "DESIGN.md").read_text()
    files = [*(ROOT / "ui").glob("*.py"), *(ROOT / "ui" / "panels").glob("*.py")]
    unnamed = {f.name for f in files if f"`{f.name}`" not in note} - {"__init__.py"}
    assert unnamed == set()


def test_every_relative_link_of_the_docs_leads_somewhere() -> None:
    """Pictures too."""
    for text in (ROOT / "docs").glob("*.md"):
        for target in re.findall(r"\]\(([^)#:]+)\)", text.read_text()):
            assert (text.parent / target).exists(), (text.name, target)


def test_the_screenshots_stay_small() -> None:
    """Each below 200 KB, all together below 2 MB."""
    sizes = [picture.stat().st_size for picture in (ROOT / "docs" / "screens").iterdir()]
    assert sizes
    assert max(sizes) < 200_000
    assert sum(sizes) < 2_000_000
