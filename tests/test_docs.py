"""Pages written by hand are kept honest: every key, field, choice and name is there."""

from __future__ import annotations

import dataclasses
import re
from typing import Any

import pytest

from designs.family import families
from docs.generate_command_line import commands
from geometry.objects.everyday import EVERYDAY
from sim.contact.motion.approach import FARTHEST_TARGET_MM
from sim.forces.training.settings import PRESETS
from sim.optics.field.model import models as models_in_order
from sim.optics.maps.map_kind import map_kinds
from tests.pages import BY_HAND, DOCS, ROOT, code, first_column, page, words
from workbench.core.base.errors import DesignError
from workbench.core.design.camera import Camera, ImageSensor, LensModel
from workbench.core.design.lighting import Baking, Lamp, LampKind, LedMount, LedRing, LightModel
from workbench.core.design.making import Casting, Housing, MouldOptions
from workbench.core.design.optics import Coating, Composition, MarkerPattern, Markers, Optics
from workbench.core.press.indenter import IndenterKind
from workbench.core.press.motion import StrokeKind
from workbench.core.result.force_field import Source
from workbench.edit.strokes import read_stroke
from workbench.learning.dataset.cases import Split
from workbench.learning.dataset.recipes import RECIPES
from workbench.project.design_toml import design_from_toml
from workbench.project.named_designs import presets
from workbench.project.photos import shipped_photos
from workbench.project.saved_designs import MOST_VERSIONS
from workbench.report.export import exports
from workbench.system.folder import CAMERA_FILES, NUMBER, RUN_FILES

KEYS = (
    "schema design family device stages stage key cached seconds contact reaction_N normal_N "
    "residual penetration_mm particles grid_mm substeps images moulds file watertight volume_mm3 "
    "metrics surface_points_mm surface_faces displacement_mm indenter_pose background.png "
    "frame_000.png contact.npz report.html summary.json "
    "forces.csv slip.csv poses.csv failed settled von_mises_MPa cauchy_MPa contact_force_N "
    "light_model press maps difference_000.png motion_000.png markers.csv frames.npz maps.npz "
    "name case value unit reference null ceiling error error_kind limit sense ok"
).split()


@pytest.mark.parametrize("key", KEYS)
def test_every_contract_key_is_documented(key: str) -> None:
    """Other tools read these names: each stands in formats.md as code, a whole word."""
    assert key in words("formats")


MADE = {name for kind in exports().values() for name in kind.makes if not name.endswith("/*")}


@pytest.mark.parametrize("pattern", sorted({*RUN_FILES, *MADE} - set(CAMERA_FILES)))
def test_every_file_that_a_run_or_an_export_writes_is_documented(pattern: str) -> None:
    """As code in formats.md or making.md; numbered ones by the first, folders by their ending."""
    name = pattern.replace(NUMBER, "000").rpartition("/")[2]
    assert name.replace("_*.", "_000.") in code("formats").split() + code("making").split()


@pytest.mark.parametrize("part", [Camera, ImageSensor, LedRing, Lamp, Coating, Markers, Baking])
def test_every_field_of_the_optics_is_explained(part: Any) -> None:
    """A designer finds what each field is for."""
    fields = {item.name for item in dataclasses.fields(part)}
    # The image sensor has a table of its own: `[optics.camera.sensor]`.
    assert fields - {"sensor"} <= set(re.findall(r"\w+", code("optics"))), part


@pytest.mark.parametrize("part", [MouldOptions, Casting])
def test_every_field_of_making_is_explained(part: Any) -> None:
    """What a designer chooses about mould and recipe."""
    assert {item.name for item in dataclasses.fields(part)} <= words("making")


def test_the_housing_is_told_by_fields_that_it_has() -> None:
    """Those that the page names."""
    assert {"wall_mm", "clearance_mm"} <= {item.name for item in dataclasses.fields(Housing)}


@pytest.mark.parametrize(
    "choice", [LightModel, LensModel, LampKind, LedMount, MarkerPattern, Composition]
)
def test_every_choice_of_the_optics_is_explained(choice: Any) -> None:
    """Each light model, lens, form of a lamp, mount, pattern and composition, as code."""
    assert {member.value for member in choice} <= set(re.findall(r"\w+", code("optics")))


def test_the_tables_of_choices_are_whole() -> None:
    """One row for each light model and each lens; the default model is the program's."""
    models = first_column(page("optics"), "name | equation")
    assert models == [model.value for model in models_in_order()]
    assert first_column(page("optics"), "`lens`") == [lens.value for lens in LensModel]
    (default,) = re.findall(r"^\| `(\w+)` \(default\) \|", page("optics"), re.MULTILINE)
    assert default == Optics().light_model.value


def test_every_shipped_photograph_is_documented() -> None:
    """Each is written as a design names it."""
    assert {f"builtin:{name}" for name in shipped_photos()} <= set(code("optics").split())


def test_every_map_and_its_score_are_documented() -> None:
    """Names as the maps' source gives them; single lights are numbered there."""
    names = {*map_kinds(), *(kind.figure for kind in map_kinds().values())}
    names |= {"led_01", "led_01_reach_percent"}
    assert len(names) == 28
    assert names <= words("maps"), names


def test_the_example_of_optics_is_a_design() -> None:
    """Two cameras, 6 LEDs and a line of 9 points over a photograph, as the page writes it."""
    blocks = re.findall(r"^```toml\n(.*?)^```$", page("optics"), re.MULTILINE | re.DOTALL)
    (optics,) = (design_from_toml(block).optics for block in blocks)
    assert isinstance(optics, Optics) and optics.background is not None
    assert (len(optics.all_cameras), optics.lights) == (2, 15)


def test_the_example_of_a_design_is_one() -> None:
    """A slim finger with a stiffer coat; the second example wants files that are not there."""
    first, second = re.findall(r"^```toml\n(.*?)^```$", page("designs"), re.MULTILINE | re.DOTALL)
    design = design_from_toml(first)
    assert (design.shape["cylinder_mm"], len(design.material.inclusions)) == (30.0, 1)
    # Everything but its two files is as the program wants it.
    with pytest.raises(DesignError, match=r"no file 'bone\.stl' for the body"):
        design_from_toml(second)


def test_objects_and_families_are_all_named() -> None:
    """The objects are exactly what `--indenter` takes by name; the families those there are."""
    (told,) = re.findall(r"`--indenter` takes one of (.*?); or a file", page("contact"), re.DOTALL)
    kinds = {kind.value for kind in IndenterKind if kind is not IndenterKind.MESH}
    assert set(re.findall(r"`(\w+)`", told)) == kinds | set(EVERYDAY)
    (told,) = re.findall(r"parameters of its own: (.*?) for a body", page("designs"), re.DOTALL)
    assert set(re.findall(r"`(\w+)`", told)) == set(families())


def test_the_table_of_strokes_is_what_may_be_typed() -> None:
    """Each row is read as a stroke, and each kind has one."""
    found = [read_stroke(row, frames=2).kind for row in first_column(page("contact"), "stroke")]
    assert found == list(StrokeKind)


def test_numbers_in_the_text_are_the_programs() -> None:
    """Versions that are kept, how far a target may be off, and the splits of a data set."""
    assert f"the {MOST_VERSIONS} versions before" in page("designs")
    assert f"more than {FARTHEST_TARGET_MM:g} mm refused" in page("contact")
    (told,) = re.findall(r"are in one split \((.*?)\)", page("data-sets"))
    assert re.findall(r"`(\w+)`", told) == [split.value for split in Split]


def test_sources_of_forces_recipes_and_presets_are_all_named() -> None:
    """The table of sources is whole; the sentences name exactly those there are."""
    assert first_column(page("forces"), "source") == [source.value for source in Source]
    (told,) = re.findall(r"The recipes that ship are (.*?)\.", page("data-sets"), re.DOTALL)
    assert set(re.findall(r"`(\w+)`", told)) == set(RECIPES)
    (told,) = re.findall(r"Presets are (.*?)\.", page("data-sets"), re.DOTALL)
    assert set(re.findall(r"`(\w+)`", told)) == set(PRESETS)


def test_elements_of_the_deck_are_the_programs() -> None:
    """Each that can be chosen, and the one that is the default."""
    (element,) = (a for a in commands()["fem export"]._actions if a.dest == "element")
    assert set(re.findall(r"`(C3D\w+)`", page("forces"))) == set(element.choices or ())
    assert f"`{element.default}`, the default" in page("forces")


@pytest.mark.parametrize("name", BY_HAND)
def test_a_page_is_reached_from_the_readme(name: str) -> None:
    """And begins with its title."""
    assert f"(docs/{name}.md)" in (ROOT / "README.md").read_text()
    assert page(name).startswith("# ")


def test_presets_open_with_their_purpose() -> None:
    """The first line of a preset says what it is."""
    assert all(len(purpose) > 20 for purpose in presets().values())


def test_the_screenshots_stay_small() -> None:
    """Each below 200 KB, all together below 2 MB."""
    sizes = [picture.stat().st_size for picture in (DOCS / "screens").iterdir()]
    assert sizes
    assert max(sizes) < 200_000
    assert sum(sizes) < 2_000_000
