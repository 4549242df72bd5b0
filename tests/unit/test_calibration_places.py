"""Where a photographed contact is on the skin, and presses that are carried to other places."""

from __future__ import annotations

import numpy as np
import pytest

from sim.optics.light.places import check_lights
from sim.optics.proof.specimen import dent, finger
from workbench.calibration.ball_presses import BallPress, carried
from workbench.calibration.light_sources import NO_RING, candidates, single_lights
from workbench.calibration.seen.photo_set import BallPhoto, Circle
from workbench.calibration.seen.seen_places import ContactPlace, SeenPlaces
from workbench.core.base.errors import DesignError
from workbench.core.design.camera import Camera
from workbench.core.design.lighting import Lamp, LedRing
from workbench.core.design.optics import Optics
from workbench.core.result.results import MembraneMesh

CAMERA = Camera(width_px=160, height_px=120)


@pytest.fixture(scope="module")
def mesh() -> MembraneMesh:
    return finger(edge_mm=0.8)


def photo() -> BallPhoto:
    return BallPhoto(
        name="p.png",
        image=np.zeros((120, 160, 3), np.uint8),
        ball_mm=6.0,
        circle=None,
        place_mm=None,
        depth_mm=None,
        force_N=None,
        held_out=False,
    )


def test_the_middle_of_the_image_is_the_tip(mesh: MembraneMesh) -> None:
    """A finger of radius 15 and height 42, seen through 100 degrees from 0.3 mm over its base.

    A pixel is (2 tan 50) / 160 of the depth; the wall's refraction takes off some 10 percent.
    """
    places = SeenPlaces(mesh, Optics(camera=CAMERA))
    found = places.place(Circle(column_px=79.5, row_px=59.5, radius_px=10.0), "p.png")
    assert found.point_mm == pytest.approx([0.0, 0.0, 42.0], abs=0.4)
    assert found.normal == pytest.approx([0.0, 0.0, 1.0], abs=0.03)
    assert found.radius_mm == pytest.approx(10 * 41.7 * 2 * np.tan(np.radians(50)) / 160, rel=0.12)
    assert places.wall_mm(found) == pytest.approx(2.0, abs=0.05)
    assert places.flat_to_mm(found) < 2.0, "a ball of 15 mm bends by 2 degrees within half a mm"


def test_a_circle_beside_the_skin_is_refused(mesh: MembraneMesh) -> None:
    """A camera that looks down and out sees no skin in its corner."""
    down = Camera(width_px=160, height_px=120, position_mm=(0.0, 0.0, 20.0), wxyz=(0.6, 0.8, 0, 0))
    places = SeenPlaces(mesh, Optics(camera=down))
    blind = np.argwhere(~places._seen.reshape(120, 160))
    row, column = blind[len(blind) // 2]
    with pytest.raises(DesignError, match=r"p\.png has its contact at column"):
        places.place(Circle(column_px=float(column), row_px=float(row), radius_px=5.0), "p.png")


def test_a_press_is_carried_along_the_skin(mesh: MembraneMesh) -> None:
    """A dent of half a millimetre moved by 0.6 mm: as if it had been made there, to 5 percent."""

    def press(at_mm: tuple[float, float, float]) -> BallPress:
        moved = dent(mesh.outer, at_mm=at_mm, depth_mm=0.5, radius_mm=3.0)
        radial = np.array([at_mm[0], at_mm[1], 0.0]) / 15.0
        return BallPress(
            photo=photo(),
            place=ContactPlace(point_mm=np.array(at_mm), normal=radial, radius_mm=2.0),
            least_mm=0.1,
            most_mm=0.5,
            guess_mm=0.4,
            depths_mm=np.array([0.0, 0.5]),
            displacement_mm=np.stack([0.0 * moved, moved]),
            normal_N=np.array([0.0, 1.0]),
        )

    one, other = press((15.0, 0.0, 20.0)), press((15.0, 0.0, 20.6))
    got = carried(one, photo(), other.place, mesh).displaced_mm(0.5)
    made = other.displaced_mm(0.5)
    assert np.abs(got - made).max() < 0.05 * 0.5 + 0.02
    assert np.abs(got).max() == pytest.approx(0.5, abs=0.02)
    assert carried(one, photo(), other.place, mesh).force_N(0.25) == pytest.approx(0.5)


def test_candidates_stand_where_lights_may(mesh: MembraneMesh) -> None:
    """In the shell at the base and in the cavity at two heights; none in the tip's dome."""
    found = candidates(mesh)
    check_lights(mesh, NO_RING, tuple(found))
    heights = {(lamp.mount.value, round(lamp.position_mm[2])) for lamp in found}
    assert len(found) >= 24 and len(heights) >= 3
    assert all(lamp.position_mm[2] < 27.0 for lamp in found)


def test_the_designs_own_lights_are_taken_one_by_one() -> None:
    """Six LEDs and a line: seven lights, white, of power 1, where they stood."""
    optics = Optics(ring=LedRing(count=6, radius_mm=8.0), lamps=(Lamp(power=3.0),))
    found = single_lights(optics)
    assert len(found) == 7
    assert {(lamp.colour, lamp.power) for lamp in found} == {("#ffffff", 1.0)}
    assert np.hypot(*found[0].position_mm[:2]) == pytest.approx(8.0)
