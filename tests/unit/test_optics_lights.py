"""LED rings: places, colours, and the messages for places where no LED or camera can be."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from sim.optics.camera.inside_skin import inside
from sim.optics.field.bake import bake_light
from sim.optics.light.lights import place_leds
from sim.optics.light.places import check_camera, check_lights
from sim.optics.proof.specimen import finger
from workbench.core.base.errors import DesignError
from workbench.core.design.camera import Camera
from workbench.core.design.lighting import LedMount, LedRing, LightModel
from workbench.core.result.results import MembraneMesh


@pytest.fixture(scope="module")
def mesh() -> MembraneMesh:
    """Radii 15, 13 and 12 mm; light and camera belong inside 12."""
    return finger(edge_mm=1.5)


def test_ring_spreads_leds_and_colours_in_sectors() -> None:
    """Nine LEDs at 50, 90, ... 370 degrees: three red around 90, three green, three blue."""
    leds = place_leds(LedRing())
    azimuth = np.degrees(np.arctan2(leds.position_mm[:, 1], leds.position_mm[:, 0])) % 360
    assert azimuth == pytest.approx(np.arange(50, 410, 40) % 360)
    assert np.hypot(*leds.position_mm[:, :2].T) == pytest.approx(np.full(9, 9.0))
    assert np.array_equal(leds.rgb, np.repeat(np.eye(3), 3, axis=0))


def test_tilt_turns_the_axis_outward() -> None:
    """At 90 degrees an LED at +X shines along +X; at 0 along +Z."""
    ring = LedRing(count=1, phase_deg=0.0, tilt_deg=90.0)
    assert place_leds(ring).axis[0] == pytest.approx([1, 0, 0], abs=1e-12)
    assert place_leds(LedRing()).axis == pytest.approx(np.tile([0, 0, 1.0], (9, 1)))


def test_power_scales_the_colour() -> None:
    """Twice the power is twice the linear RGB."""
    double = place_leds(LedRing(power=2.0)).rgb
    assert np.array_equal(double, 2.0 * place_leds(LedRing()).rgb)


def test_inside_knows_cavity_wall_and_outside(mesh: MembraneMesh) -> None:
    """Radius 11.5 lies in the cavity, 12.5 not; 14.5 lies in the body, 15.5 not."""
    points = np.array([[r, 0.1, 10.0] for r in (11.5, 12.5, 14.5, 15.5)])
    assert inside(mesh.cavity, points).tolist() == [True, False, False, False]
    assert inside(mesh.outer, points).tolist() == [True, True, True, False]


def _light_error(mesh: MembraneMesh, ring: LedRing) -> DesignError:
    with pytest.raises(DesignError) as caught:
        check_lights(mesh, ring)
    return caught.value


@pytest.mark.parametrize(
    ("radius_mm", "mount", "place", "limit"),
    [
        (12.5, LedMount.CAVITY, "in the support", "cavity ends at 1"),
        (14.0, LedMount.CAVITY, "in the elastomer wall", "cavity ends at 1"),
        (20.0, LedMount.CAVITY, "in the space outside", "cavity ends at 1"),
        (9.0, LedMount.SHELL, "in the cavity", "support reaches from 1"),
        (14.0, LedMount.SHELL, "in the elastomer wall", "support reaches from 1"),
    ],
)
def test_misplaced_led_names_place_and_limit(
    mesh: MembraneMesh, radius_mm: float, mount: LedMount, place: str, limit: str
) -> None:
    """The cavity ends at 12 mm (11.9 between mesh vertices), the support at 13."""
    error = _light_error(mesh, LedRing(radius_mm=radius_mm, mount=mount))
    assert error.at == "optics.ring.radius_mm"
    assert f"radius {radius_mm:g} mm" in error.message
    assert place in error.message and limit in error.message
    assert "set radius_mm" in error.hint


def test_shell_leds_fit_in_the_support(mesh: MembraneMesh) -> None:
    """12.5 mm lies between 12 and 13 mm; inside the cavity, which ends at 12, it does not."""
    ring = LedRing(radius_mm=12.5, mount=LedMount.SHELL)
    check_lights(mesh, ring)
    inside = dataclasses.replace(ring, mount=LedMount.CAVITY)
    assert _light_error(mesh, inside).at == "optics.ring.radius_mm"


def test_led_above_the_tip_names_the_height(mesh: MembraneMesh) -> None:
    """The cavity ends at 27 + 12 = 39 mm."""
    error = _light_error(mesh, LedRing(height_mm=60.0))
    assert error.at == "optics.ring.height_mm" and "39 mm" in error.message


def test_led_below_the_base_names_the_base(mesh: MembraneMesh) -> None:
    """A base at 1 mm refuses LEDs at 0.5 mm."""
    lifted = mesh.cavity.points_mm + np.array([0.0, 0.0, 1.0])
    cavity = dataclasses.replace(mesh.cavity, points_mm=lifted)
    error = _light_error(dataclasses.replace(mesh, cavity=cavity), LedRing())
    assert "below the base at 1 mm" in error.message and error.at == "optics.ring.height_mm"


def test_dark_leds_are_refused_not_rendered_black(mesh: MembraneMesh) -> None:
    """Power 0, or the colour black, is an error with exit status 2."""
    assert _light_error(mesh, LedRing(power=0.0)).at == "optics.ring.power"
    dark = _light_error(mesh, LedRing(colours=("#000000",)))
    assert dark.at == "optics.ring.colours" and dark.exit_code == 2


def test_baking_checks_the_lights(mesh: MembraneMesh) -> None:
    """bake_light refuses what check_lights refuses."""
    with pytest.raises(DesignError, match="in the support"):
        bake_light(mesh, LedRing(radius_mm=12.5), model=LightModel.LINEAR)


@pytest.mark.parametrize(
    ("position_mm", "words"),
    [
        ((12.5, 0.0, 10.0), "inside the wall; the cavity ends 1"),
        ((0.0, 14.0, 10.0), "inside the wall; the cavity ends 1"),
        ((30.0, 0.0, 10.0), "outside the sensor; the cavity ends 1"),
        ((0.0, 0.0, 100.0), "outside the sensor; the cavity ends at height 39 mm"),
        ((0.0, 0.0, -2.0), "below the base at 0 mm"),
    ],
)
def test_misplaced_camera_names_place_and_limit(
    mesh: MembraneMesh, position_mm: tuple[float, float, float], words: str
) -> None:
    """A camera belongs into the cavity of radius 12 mm."""
    with pytest.raises(DesignError) as caught:
        check_camera(mesh, Camera(position_mm=position_mm))
    assert words in caught.value.message
    assert caught.value.at == "optics.camera.position_mm" and caught.value.hint


def test_camera_that_looks_out_of_the_base_says_how_little_it_sees(mesh: MembraneMesh) -> None:
    """Turned by 180 degrees about X it looks down through the open base: 0 % of the pixels."""
    with pytest.raises(DesignError) as caught:
        check_camera(mesh, Camera(wxyz=(0.0, 1.0, 0.0, 0.0)))
    assert caught.value.message.startswith("only 0.0% of the pixels see the skin")
    assert caught.value.at == "optics.camera" and "wxyz" in caught.value.hint
