"""Lamps, cones and single powers; and what is said where there is no light or no room for it."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest

from sim.optics.field.bake import bake_light
from sim.optics.light.lights import place_leds
from sim.optics.light.lobe import emitted
from sim.optics.light.places import camera_field, check_camera, check_lenses, check_lights
from sim.optics.proof.specimen import finger
from workbench.core.base.errors import DesignError
from workbench.core.design.camera import Camera, LensModel
from workbench.core.design.leds import lamp_points
from workbench.core.design.lighting import Lamp, LampKind, LedMount, LedRing, LightModel
from workbench.core.design.optics import Optics
from workbench.core.result.results import MembraneMesh

NONE = LedRing(count=0)


@pytest.fixture(scope="module")
def mesh() -> MembraneMesh:
    """Radii 15, 13 and 12 mm; light and camera belong inside 12."""
    return finger(edge_mm=1.5)


def test_a_point_is_where_it_was_put() -> None:
    """One point, its axis of length 1."""
    places, axes = lamp_points(Lamp(position_mm=(1.0, 2.0, 3.0), axis=(0.0, 0.0, 5.0)))
    assert places.tolist() == [[1.0, 2.0, 3.0]] and axes.tolist() == [[0.0, 0.0, 1.0]]


def test_a_line_has_a_point_in_the_middle_of_each_part() -> None:
    """Four parts of 4 mm along X: -1.5, -0.5, 0.5, 1.5 mm."""
    lamp = Lamp(kind=LampKind.LINE, length_mm=4.0, samples=4, along=(2.0, 0.0, 0.0))
    places, axes = lamp_points(lamp)
    assert places[:, 0] == pytest.approx([-1.5, -0.5, 0.5, 1.5])
    assert np.ptp(places[:, 1:], axis=0) == pytest.approx([0.0, 0.0]) and len(axes) == 4


@pytest.mark.parametrize(
    ("samples", "grid"), [(9, (5, 2)), (10, (5, 2)), (1, (1, 1)), (2, (2, 1)), (40, (10, 4))]
)
def test_an_area_takes_the_nearest_grid_of_square_cells(
    samples: int, grid: tuple[int, int]
) -> None:
    """5 x 2 mm: ten points are five by two cells of 1 mm; nine are, too, and the lamp says so."""
    lamp = Lamp(kind=LampKind.AREA, length_mm=5.0, width_mm=2.0, samples=samples)
    assert lamp.grid == grid and lamp.points == grid[0] * grid[1]
    places, _ = lamp_points(lamp)
    assert len(places) == lamp.points
    reach = np.array([5.0 * (1 - 1 / grid[0]), 2.0 * (1 - 1 / grid[1])])
    assert np.ptp(places[:, :2], axis=0) == pytest.approx(reach)


def test_an_area_is_square_to_its_axis() -> None:
    """`along` is turned into the plane across `axis`."""
    lamp = Lamp(kind=LampKind.AREA, axis=(1.0, 0.0, 1.0), along=(1.0, 0.0, 0.0))
    places, axes = lamp_points(lamp)
    assert np.abs((places - np.array(lamp.position_mm)) @ axes[0]).max() < 1e-12


def test_ring_and_lamps_are_one_list() -> None:
    """Ring first; a lamp's power is shared out to its points, a ring's follows `powers`."""
    ring = LedRing(count=2, powers=(1.0, 0.5), power=2.0, colours=("#ffffff",), cone_deg=60.0)
    lamp = Lamp(kind=LampKind.LINE, samples=4, power=2.0, colour="#ff0000", mount=LedMount.SHELL)
    leds = place_leds(ring, (lamp,))
    assert leds.rgb[:2].tolist() == [[2.0] * 3, [1.0] * 3]
    assert leds.rgb[2:].sum(axis=0).tolist() == [2.0, 0.0, 0.0]
    assert leds.cone == pytest.approx([math.cos(math.radians(30))] * 2 + [0.0] * 4)
    assert leds.in_shell.tolist() == [False] * 2 + [True] * 4


@pytest.mark.parametrize("exponent", [0.0, 1.0, 4.0])
@pytest.mark.parametrize("cone_deg", [180.0, 90.0, 20.0])
def test_a_cone_keeps_the_power(exponent: float, cone_deg: float) -> None:
    """The flux through a sphere of radius 7 mm is 1, whatever lobe and cone."""
    cosine = (np.arange(200_000) + 0.5) / 200_000
    direction = -np.column_stack([np.sqrt(1 - cosine**2), 0 * cosine, cosine])
    cone = 0.0 if cone_deg == 180.0 else math.cos(math.radians(cone_deg / 2))
    received = emitted(
        direction,
        np.full(len(cosine), 7.0),
        axis=np.array([0.0, 0.0, 1.0]),
        exponent=exponent,
        cone=cone,
    )
    # A midpoint sum over the half sphere: bands of equal height have equal area. The edge of the
    # narrowest cone cuts a band of 5e-6, of the 0.015 that are lit.
    assert (received * 2 * np.pi * 7.0**2).mean() == pytest.approx(1.0, rel=5e-4)


def test_a_lamp_lights_the_skin_like_a_led(mesh: MembraneMesh) -> None:
    """A point lamp at an LED's place gives the LED's light, to the bit."""
    ring = LedRing(count=1, radius_mm=5.0, phase_deg=0.0, height_mm=2.0, colours=("#ffffff",))
    lamp = Lamp(position_mm=(5.0, 0.0, 2.0))
    one = bake_light(mesh, ring, model=LightModel.DIRECT)
    other = bake_light(mesh, NONE, (lamp,), model=LightModel.DIRECT)
    assert np.array_equal(one.irradiance, other.irradiance)
    assert np.array_equal(one.direction, other.direction)


@pytest.mark.parametrize("model", [LightModel.LINEAR, LightModel.PLANE_NORMAL, LightModel.GEODESIC])
def test_every_point_of_light_has_its_field(mesh: MembraneMesh, model: LightModel) -> None:
    """Two LEDs and a lamp of four points are six unit fields."""
    lamp = Lamp(kind=LampKind.LINE, samples=4)
    light = bake_light(mesh, LedRing(count=2), (lamp,), model=model)
    assert light.direction.shape == (6, len(mesh.seen.points_mm), 3)
    assert np.linalg.norm(light.direction, axis=2) == pytest.approx(1.0, abs=1e-6)
    assert (light.irradiance == 1.0).all()


def test_photons_bake_nothing(mesh: MembraneMesh) -> None:
    """Straight lines without strength: each frame traces its own."""
    light = bake_light(mesh, LedRing(), model=LightModel.PHOTONS)
    assert not light.irradiance.any() and light.scattered is None


def refusal(mesh: MembraneMesh, ring: LedRing, *lamps: Lamp) -> DesignError:
    """The error of these lights."""
    with pytest.raises(DesignError) as caught:
        check_lights(mesh, ring, lamps)
    assert caught.value.hint
    return caught.value


@pytest.mark.parametrize(
    ("lamp", "says"),
    [
        (Lamp(position_mm=(14.0, 0, 5)), "lamp 2 at radius 14 mm, height 5 mm is in the elastomer"),
        (Lamp(position_mm=(0, 12.5, 5)), "is in the support; the cavity ends at 1"),
        (Lamp(position_mm=(40.0, 0, 5)), "lamp 2 at radius 40 mm, height 5 mm is in the space out"),
        (Lamp(position_mm=(0, 0, 80)), "the cavity ends at height 39 mm"),
        (Lamp(position_mm=(3, 0, 5), mount=LedMount.SHELL), "is in the cavity; the support reache"),
        (
            Lamp(kind=LampKind.LINE, length_mm=26.0, samples=5, position_mm=(4, 0, 5)),
            "lamp 2 reaches into the elastomer wall at radius 14.4 mm",
        ),
    ],
)
def test_a_misplaced_lamp_names_place_distance_and_limit(
    mesh: MembraneMesh, lamp: Lamp, says: str
) -> None:
    """Lamps count from 1; the cavity ends at 12 mm, or 11.9 between vertices."""
    error = refusal(mesh, LedRing(), Lamp(), lamp)
    assert says in error.message
    assert error.at == "optics.lamps[2].position_mm"


def test_a_lamp_below_the_base_is_refused(mesh: MembraneMesh) -> None:
    """Its lowest point and the base."""
    error = refusal(mesh, LedRing(), Lamp(position_mm=(0.0, 0.0, -1.0)))
    assert "lamp 1 reaches down to -1 mm, below the base at 0 mm" in error.message


def test_a_lamp_in_the_camera_is_fine(mesh: MembraneMesh) -> None:
    """A ring light about the lens, as a point; 100 mm below it there is no sensor."""
    x, y, z = Camera().position_mm
    check_lights(mesh, NONE, (Lamp(position_mm=(x, y, z)),))
    assert "below the base" in refusal(mesh, NONE, Lamp(position_mm=(x, y, z - 100.0))).message


@pytest.mark.parametrize(
    ("ring", "lamps", "says", "at"),
    [
        (NONE, (), "there is no light", "optics.ring.count"),
        (LedRing(power=0.0), (), "all LEDs have power 0", "optics.ring.power"),
        (LedRing(count=1, powers=(0.0,)), (), "all LEDs have power 0", "optics.ring.power"),
        (LedRing(colours=("#000000",)), (), "are black (#000000)", "optics.ring.colours"),
        (NONE, (Lamp(power=0.0),), "all lamps have power 0", "optics.lamps.power"),
        (NONE, (Lamp(colour="#000000"),), "are black (#000000)", "optics.lamps.colour"),
        (LedRing(power=0.0), (Lamp(power=0.0),), "all LEDs and lamps have", "optics.ring.power"),
    ],
)
def test_no_light_is_refused_not_rendered_black(
    mesh: MembraneMesh, ring: LedRing, lamps: tuple[Lamp, ...], says: str, at: str
) -> None:
    """Why the image would be black, and the field."""
    error = refusal(mesh, ring, *lamps)
    assert says in error.message and error.at == at


def test_one_light_is_enough(mesh: MembraneMesh) -> None:
    """A dark ring with a bright lamp is a sensor."""
    check_lights(mesh, LedRing(power=0.0), (Lamp(),))
    assert Optics(ring=NONE, lamps=(Lamp(),)).lights == 1


def test_further_cameras_are_named(mesh: MembraneMesh) -> None:
    """The second further camera is `optics.cameras[2]`, in every message."""
    good = Camera(fov_x_deg=90.0)
    folds = dataclasses.replace(good, lens=LensModel.OPENCV, distortion=(-0.5, 0.0, 0.0, 0.0))
    with pytest.raises(DesignError) as early:
        check_lenses(Optics(cameras=(good, folds)))
    assert early.value.at == "optics.cameras[2].distortion"
    for bad, field in (
        (dataclasses.replace(good, position_mm=(14.0, 0.0, 5.0)), ".position_mm"),
        (dataclasses.replace(good, wxyz=(0.0, 1.0, 0.0, 0.0)), ""),
        (folds, ".distortion"),
    ):
        with pytest.raises(DesignError) as caught:
            check_camera(mesh, bad, at=camera_field(Optics(cameras=(good, bad)), bad))
        assert caught.value.at == f"optics.cameras[2]{field}"


@pytest.mark.parametrize("lens", [LensModel.EQUIDISTANT, LensModel.OPENCV_FISHEYE])
@pytest.mark.parametrize("turn_deg", [0.0, 60.0, 90.0])
def test_a_fisheye_sees_the_skin_however_it_is_tilted(
    mesh: MembraneMesh, lens: LensModel, turn_deg: float
) -> None:
    """180 degrees across from the middle of the cavity, tilted up to the wall; not from outside."""
    half = math.radians(turn_deg) / 2
    turned = (math.cos(half), math.sin(half), 0.0, 0.0)
    camera = Camera(lens=lens, fov_x_deg=180.0, position_mm=(0.0, 0.0, 10.0), wxyz=turned)
    check_camera(mesh, camera)
    with pytest.raises(DesignError, match="outside the sensor"):
        check_camera(mesh, dataclasses.replace(camera, position_mm=(60.0, 0.0, 10.0)))


@pytest.mark.parametrize("name", ["axis", "along"])
def test_directions_of_a_lamp_have_an_upper_limit(name: str) -> None:
    """1e200 is finite, but its square is not; a million is taken."""
    for taken in ((1e6, 0.0, 0.0), (0.0, -1e6, 0.0)):
        assert getattr(dataclasses.replace(Lamp(), **{name: taken}), name) == taken
    with pytest.raises(DesignError, match="outside -1e\\+06 to 1e\\+06") as caught:
        dataclasses.replace(Lamp(), **{name: (0.0, 0.0, 1e200)})
    assert caught.value.at == f"optics.lamps.{name}"
