"""What the optics tab turns edits into: angles, lens presets, colours, items of lists."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from sim.optics.camera.camera import pixel_directions
from sim.optics.field.model import models
from ui.desk.session import Session
from workbench.core.base.errors import DesignError
from workbench.core.design.camera import Camera, LensModel
from workbench.core.design.design import SensorDesign
from workbench.core.design.leds import lamp_points
from workbench.core.design.lighting import Lamp, LampKind, LedRing, LightModel
from workbench.core.design.optics import Optics
from workbench.edit.camera_edit import LENSES, angles_of, further_camera, with_lens, wxyz_of
from workbench.edit.item_fields import read_field, with_field, without_item
from workbench.edit.light_edit import (
    NAMED,
    colour_words,
    lamp_corners_mm,
    new_lamp,
    read_colour,
    read_colours,
    read_numbers,
)
from workbench.project.design_toml import design_from_toml
from workbench.project.project import Project

LAMPS = (Lamp(), Lamp(kind=LampKind.LINE, power=2.0))


def designed(**optics: object) -> SensorDesign:
    return SensorDesign(optics=Optics(**optics))  # pyright: ignore[reportArgumentType]


@pytest.mark.parametrize(
    "angles_deg",
    [(0.0, 0.0, 0.0), (0.0, 0.0, 90.0), (30.0, 40.0, 0.0), (90.0, 170.0, -170.0), (120.0, -5, 60)],
)
def test_angles_survive_the_quaternion(angles_deg: tuple[float, float, float]) -> None:
    """Tilt, pan and roll come back to 1e-4 degree, to which they are rounded."""
    found = angles_of(wxyz_of(angles_deg))
    np.testing.assert_allclose(found, angles_deg, atol=1e-4)


def test_a_tilted_camera_looks_toward_its_azimuth() -> None:
    """Tilt 90 and pan 90 look along +Y; without roll the image's x stays along the sensor's X."""
    camera = Camera(width_px=161, height_px=121, wxyz=wxyz_of((90.0, 90.0, 0.0)))
    middle, right = pixel_directions(camera, np.array([[80.5, 60.5], [160.5, 60.5]]))
    np.testing.assert_allclose(middle, [0.0, 1.0, 0.0], atol=1e-6)
    assert right[0] > 0.5
    assert abs(right[2]) < 1e-6


def test_a_straight_camera_has_no_pan() -> None:
    """Any pan of an upright camera is the same quaternion, the identity."""
    assert wxyz_of((0.0, 77.0, 0.0)) == (1.0, 0.0, 0.0, 0.0)


def test_lens_presets_keep_all_but_the_lens() -> None:
    """Each gives its own angle; 120 and 160 are equidistant; distortion goes, the place stays."""
    camera = Camera(lens=LensModel.OPENCV, distortion=(0.1, 0, 0, 0), position_mm=(0, 0, 2.0))
    for name, (fov_x_deg, lens) in LENSES.items():
        found = with_lens(camera, name)
        assert (found.fov_x_deg, found.lens) == (fov_x_deg, lens)
        assert found.fov_x_deg == float(name)
        assert found.distortion == ()
        assert found.position_mm == camera.position_mm
    assert {LENSES[name][1] for name in ("120", "160")} == {LensModel.EQUIDISTANT}


def test_a_further_camera_differs_from_the_first() -> None:
    """It is tilted by 20 degrees more, or messages could not tell the two apart."""
    assert angles_of(further_camera(Camera()).wxyz) == (20.0, 0.0, 0.0)


def test_colours_are_read_as_designers_write_them() -> None:
    """Names, hex, peaks and temperatures, with commas or spaces; writing gives them back."""
    text = "red #00ff00, 525nm/35nm;5600K"
    colours = read_colours(text, at="optics.ring.colours")
    assert colours == ("#ff0000", "#00ff00", "525nm/35nm", "5600K")
    assert LedRing(colours=colours).colours == colours
    assert read_colours(colour_words(colours), at="x") == colours
    with pytest.raises(DesignError, match="no colour") as caught:
        read_colours(" , ", at="optics.ring.colours")
    assert caught.value.at == "optics.ring.colours"
    with pytest.raises(DesignError, match="2 colours"):
        read_colour("red, blue", at="optics.lamps[1].colour")


@pytest.mark.parametrize("text", ["orange", "#ff80", "12", "525 nm"])
def test_what_is_no_colour_is_told_what_is(text: str) -> None:
    """The refusal has the word, every form, and the names."""
    with pytest.raises(DesignError, match="is not a colour") as caught:
        read_colours(f"red, {text}", at="optics.ring.colours")
    for form in ("#rrggbb", "525nm/35nm", "5600K", *NAMED):
        assert form in caught.value.hint


def test_a_wavelength_out_of_range_is_told_its_range() -> None:
    """It is a colour in form: the design says which are taken."""
    with pytest.raises(DesignError, match="outside 380 to 780 nm"):
        LedRing(colours=read_colours("900nm", at="optics.ring.colours"))


def test_numbers_are_read_or_refused() -> None:
    """An empty text is no number at all; a word among them is told."""
    assert read_numbers("-0.12, 0.01 0;0", at="x") == (-0.12, 0.01, 0.0, 0.0)
    assert read_numbers("  ", at="x") == ()
    with pytest.raises(DesignError, match=r"'0\.1, k2'"):
        read_numbers("0.1, k2", at="optics.camera.distortion")


def test_every_light_model_has_a_line() -> None:
    """All nine, each told in at most 80 characters."""
    assert set(models()) == set(LightModel)
    assert max(len(model.hint) for model in models().values()) <= 80
    assert len({model.place for model in models().values()}) == len(models())


@pytest.mark.parametrize("kind", list(LampKind))
def test_lamps_are_drawn_where_they_shine(kind: LampKind) -> None:
    """The middle of the drawn corners and of the points of light is the lamp's place."""
    lamp = Lamp(kind=kind, position_mm=(3.0, -2.0, 1.0), axis=(1, 0, 1), along=(1, 1, 0))
    places, _ = lamp_points(lamp)
    corners = lamp_corners_mm(lamp)
    np.testing.assert_allclose(corners.mean(axis=0), lamp.position_mm, atol=1e-12)
    np.testing.assert_allclose(places.mean(axis=0), lamp.position_mm, atol=1e-12)
    reach = np.abs(places - lamp.position_mm).max(axis=0)
    assert (reach <= np.abs(corners - lamp.position_mm).max(axis=0) + 1e-12).all()


def test_a_new_lamp_stands_half_as_far_out_as_the_ring() -> None:
    """At (4.5, 0, 0.5) mm for the ring of 9 mm radius at 0.5 mm."""
    assert new_lamp(LampKind.AREA, LedRing()).position_mm == (4.5, 0.0, 0.5)


def test_one_lamp_of_several_is_changed() -> None:
    """Lamp 2 gets its power; lamp 1 is the same object."""
    design = designed(lamps=LAMPS)
    changed = with_field(design, "optics.lamps[2].power", 3.0)
    assert changed.optics.lamps[0] is LAMPS[0]
    assert changed.optics.lamps[1].power == 3.0
    assert read_field(changed, "optics.lamps[2].power") == 3.0
    assert without_item(changed.optics.lamps, 1) == changed.optics.lamps[1:]


def test_nested_fields_and_whole_items_are_changed() -> None:
    """The gamma of a further camera's image sensor, and the whole camera."""
    design = designed(cameras=(Camera(),))
    changed = with_field(design, "optics.cameras[1].sensor.gamma", 2.2)
    assert changed.optics.cameras[0].sensor.gamma == 2.2
    assert changed.optics.camera.sensor.gamma == 0.0
    other = Camera(fov_x_deg=60.0)
    assert with_field(design, "optics.cameras[1]", other).optics.cameras == (other,)


@pytest.mark.parametrize(
    ("path", "value"),
    [
        ("optics.lamps[2].power", -1.0),
        ("optics.lamps[1].colour", "bleu"),
        ("optics.cameras[1].fov_x_deg", 200.0),
        ("optics.cameras[1].sensor.gamma", math.nan),
    ],
)
def test_refusals_name_the_item(path: str, value: object) -> None:
    """The message of a lamp or camera is about that one, not about all of them."""
    design = designed(lamps=LAMPS, cameras=(Camera(),))
    with pytest.raises(DesignError) as caught:
        with_field(design, path, value)
    assert caught.value.at == path


@pytest.mark.parametrize(
    ("text", "at"),
    [
        ("[[optics.cameras]]\n[[optics.cameras]]\nfov_x_deg = 0", "optics.cameras[2].fov_x_deg"),
        ("[[optics.cameras]]\nsensor = {gamma = 9}", "optics.cameras[1].sensor.gamma"),
        ("[[optics.lamps]]\npower = -1", "optics.lamps[1].power"),
        ("[[optics.lamps]]\n[[optics.lamps]]\nbogus = 1", "optics.lamps[2].bogus"),
        ("[[optics.lamps]]\nkind = 'spot'", "optics.lamps[1].kind"),
        ("[optics.camera]\nfov_x_deg = 0", "optics.camera.fov_x_deg"),
    ],
)
def test_messages_of_design_files_name_the_item(text: str, at: str) -> None:
    """Counted from 1, as in the browser; the hint of a view of 0 is not about pinholes."""
    with pytest.raises(DesignError) as caught:
        design_from_toml(f'schema = 1\nname = "w"\nfamily = "finger"\n{text}\n')
    assert caught.value.at == at
    assert caught.value.hint and "pinhole" not in caught.value.hint


def test_a_view_too_wide_for_a_pinhole_names_another_lens() -> None:
    """178 degrees need an equidistant lens."""
    with pytest.raises(DesignError) as caught:
        Camera(fov_x_deg=178.0)
    assert "equidistant" in caught.value.hint


@pytest.mark.parametrize("name", ["bogus", "power.bogus"])
def test_a_field_that_no_item_has_is_refused(tmp_path: Path, name: str) -> None:
    """As any unknown field of a design."""
    session = Session(Project(tmp_path))
    session.change("design.optics.lamps", LAMPS)
    with pytest.raises(DesignError, match="there is no field") as caught:
        session.change(f"design.optics.lamps[1].{name}", 1.0)
    assert caught.value.at == f"optics.lamps[1].{name}"


def test_an_item_that_is_not_there_is_refused() -> None:
    """Lamp 3 of 2."""
    with pytest.raises(DesignError, match="has 2 items"):
        with_field(designed(lamps=LAMPS), "optics.lamps[3].power", 1.0)


def test_a_lamp_is_undone_like_any_field(tmp_path: Path) -> None:
    """Add, edit, undo twice: no lamp, and the edit of an item is one step."""
    session = Session(Project(tmp_path))
    session.change("design.optics.lamps", LAMPS)
    session.change("design.optics.lamps[2].power", 4.0)
    assert session.design.optics.lamps[1].power == 4.0
    assert session.undo()
    assert session.design.optics.lamps == LAMPS
    assert session.undo()
    assert session.design.optics.lamps == ()


def test_photons_have_no_maps_and_the_session_says_so(tmp_path: Path) -> None:
    """The stage strip leaves `maps` out, and there is no result of it."""
    session = Session(Project(tmp_path))
    assert "maps" in session.fresh()
    session.change("design.optics.light_model", LightModel.PHOTONS)
    assert "maps" not in session.fresh()
    assert session.result("maps") is None
