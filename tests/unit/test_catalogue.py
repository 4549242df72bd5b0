"""Bought cameras and LEDs: each value has a source, and becomes the right field of a design."""

from __future__ import annotations

import dataclasses

import pytest

from workbench.core.base.errors import DesignError
from workbench.core.catalogue.camera_part import CameraPart, camera_parts
from workbench.core.catalogue.led_part import LedPart, led_parts, temperature
from workbench.core.design.camera import Camera, LensModel
from workbench.core.design.design import SensorDesign
from workbench.core.design.lighting import LedRing
from workbench.edit.catalogue import camera_name, led_name, with_camera, with_leds
from workbench.project.design_toml import check_design

SHEET = "https://example.org/sheet"


@pytest.mark.parametrize("part", [*camera_parts().values(), *led_parts().values()])
def test_every_value_has_a_source(part: CameraPart | LedPart) -> None:
    """An address of all, and of single fields only where they have a value."""
    assert part.source.startswith("http")
    for name, address in part.sources.items():
        assert address.startswith("http") and getattr(part, name) is not None


def test_there_are_as_many_as_are_well_sourced() -> None:
    """8 to 12 of each; no two have one title."""
    for parts in (camera_parts(), led_parts()):
        assert 8 <= len(parts) <= 12
        assert len({part.title for part in parts.values()}) == len(parts)


@pytest.mark.parametrize("name", camera_parts())
def test_every_camera_is_taken_by_a_design(name: str) -> None:
    """Checked as a file would be, and known again by its numbers; place and direction stay."""
    before = SensorDesign(optics=dataclasses.replace(SensorDesign().optics))
    design = with_camera(before, name)
    check_design(design)
    camera, part = design.optics.camera, camera_parts()[name]
    assert camera_name(camera) == name
    assert (camera.width_px, camera.height_px, camera.fov_x_deg) == (
        *part.image_px,
        part.view_x_deg,
    )
    assert camera.position_mm == before.optics.camera.position_mm
    # A mode that sees the whole field of view has the proportions of the sensor.
    assert part.image_px[0] / part.image_px[1] == pytest.approx(
        part.pixels[0] / part.pixels[1], rel=2e-3
    )


def test_a_module_brings_lens_pupil_and_room() -> None:
    """3.04 mm at f/2 is a pupil of 1.52 mm; the board is 25 x 24 x 9 mm."""
    design = with_camera(SensorDesign(), "raspberry_pi_2")
    assert design.optics.camera.aperture_mm == pytest.approx(1.52)
    room = design.housing
    assert (room.camera_width_mm, room.camera_height_mm, room.camera_depth_mm) == (25.0, 24.0, 9.0)


def test_what_is_not_known_stays() -> None:
    """A module without a size leaves the housing, one without a focal length the pupil."""
    before = SensorDesign()
    assert with_camera(before, "sunny_ov7251").housing == before.housing
    found = with_camera(before, "arducam_ov9782_wide")
    assert found.optics.camera.aperture_mm == before.optics.camera.aperture_mm


def test_a_further_camera_leaves_the_first_and_the_housing() -> None:
    """The second of two takes the module."""
    one = SensorDesign()
    two = one.replace("optics.cameras", (Camera(),))
    found = with_camera(two, "raspberry_pi_2", number=2)
    assert found.optics.camera == one.optics.camera and found.housing == one.housing
    assert camera_name(found.optics.cameras[0]) == "raspberry_pi_2"


def test_the_projection_fits_focal_length_or_second_view() -> None:
    """90 degrees on 2 mm: 1 mm is a pinhole's focal length, 1.27 mm a fisheye's; 90 x 73.7 and
    90 x 67.5 degrees at 4 to 3 likewise.
    """

    def lens(**known: float) -> LensModel:
        return CameraPart(
            title="a",
            image_sensor="b",
            source=SHEET,
            pixels=(640, 480),
            image_px=(640, 480),
            view_x_deg=90.0,
            **known,
        ).lens

    assert lens(focal_mm=1.0, sensor_width_mm=2.0) is LensModel.PINHOLE
    assert lens(focal_mm=1.27, pixel_um=2000.0 / 640) is LensModel.EQUIDISTANT
    assert lens(view_y_deg=73.7) is LensModel.PINHOLE
    assert lens(view_y_deg=67.5) is LensModel.EQUIDISTANT
    assert lens() is LensModel.PINHOLE


@pytest.mark.parametrize("name", led_parts())
def test_every_led_is_taken_by_a_design(name: str) -> None:
    """The ring keeps its place; what has colours is known again."""
    before, part = SensorDesign(), led_parts()[name]
    found = with_leds(before, [name])
    check_design(found)
    assert found.optics.ring.radius_mm == before.optics.ring.radius_mm
    assert found.optics.ring.colours == (part.colours or before.optics.ring.colours)
    if part.colours and part.exponent is not None:
        assert led_name(found.optics.ring) in led_parts()


def test_lobes_follow_from_the_half_angle() -> None:
    """120 degrees between half intensities are Lambert's; at the angle itself half is left."""
    lambert = LedPart(title="a", source=SHEET, light=("red",), view_deg=120.0)
    narrow = dataclasses.replace(lambert, view_deg=60.0)
    assert lambert.exponent == pytest.approx(1.0)
    assert narrow.exponent is not None
    assert 0.75 ** (narrow.exponent / 2.0) == pytest.approx(0.5)
    assert dataclasses.replace(lambert, view_deg=None).exponent is None


def test_a_led_for_each_sector() -> None:
    """Red, green and blue of three makers; one lobe, the mean of 150, 120 and 120 degrees."""
    names = ["kingbright_apt1608ec", "qilste_f312qtcg", "kingbright_kp1608pbc"]
    ring = with_leds(SensorDesign(), names).optics.ring
    assert ring.colours == ("627nm/45nm", "524nm/35nm", "468nm/25nm")
    assert ring.emission_exponent == pytest.approx((0.51282 + 2.0) / 3.0, abs=1e-4)


def test_a_white_has_its_temperature() -> None:
    """McCamy: the white point D65 (0.3127, 0.3290) is 6504 K."""
    assert temperature(0.3127, 0.3290) == pytest.approx(6504, abs=10)
    assert led_parts()["kingbright_aptr3216qwf"].colours == ("6842K",)


def test_own_numbers_are_no_part() -> None:
    """The defaults are of no maker; one changed number makes a module one's own."""
    assert camera_name(Camera()) == "" and led_name(LedRing()) == ""
    camera = with_camera(SensorDesign(), "raspberry_pi_2").optics.camera
    assert camera_name(dataclasses.replace(camera, fov_x_deg=61.0)) == ""


@pytest.mark.parametrize(("take", "at"), [(with_camera, "--camera"), (with_leds, "--led")])
def test_an_unknown_part_is_refused(take: object, at: str) -> None:
    """The message names it, and the page that lists all."""
    given = "pi_cam" if at == "--camera" else ["pi_cam"]
    with pytest.raises(DesignError, match="pi_cam") as caught:
        take(SensorDesign(), given)  # type: ignore[operator]
    assert caught.value.at == at and "parts.md" in (caught.value.hint or "")
