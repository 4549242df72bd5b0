"""Pixel to skin and back: the ray of the renderer, and a round trip of a hundredth of a pixel."""

from __future__ import annotations

import time

import numpy as np
import pytest

from sim.optics.camera import refracted_rays
from workbench.core.camera import Camera
from workbench.core.optics import Optics
from workbench.core.results import MembraneMesh
from workbench.pixel_link import PixelLink, frame_link

OPTICS = Optics(camera=Camera(width_px=64, height_px=48))


@pytest.fixture(scope="module")
def dented(finger_mesh: MembraneMesh) -> PixelLink:
    """The finger with a smooth dent of 1 mm at its tip."""
    points = finger_mesh.outer.points_mm
    aside = np.hypot(points[:, 0], points[:, 1])
    depth = np.where(points[:, 2] > 20.0, np.exp(-((aside / 3.0) ** 2)), 0.0)
    moved = np.zeros_like(points)
    moved[:, 2] = -depth
    return PixelLink(finger_mesh, OPTICS, OPTICS.camera, moved)


def test_rays_are_those_of_the_renderer(finger_mesh: MembraneMesh) -> None:
    """Every ninth pixel's centre: start and direction as in the image, to single precision."""
    link = frame_link(finger_mesh, OPTICS, 0, None, 0)
    rays = refracted_rays(OPTICS.camera, finger_mesh.cavity, OPTICS.refractive_index)
    for pixel in range(0, 64 * 48, 9 * 13):
        origin, direction = link.ray(np.array([pixel % 64 + 0.5, pixel // 64 + 0.5]))
        # Both casters solve in double precision; the renderer keeps single: 4e-6 mm at 40 mm.
        assert origin == pytest.approx(rays.origin_mm[pixel], abs=1e-4)
        assert direction == pytest.approx(rays.direction[pixel], abs=1e-4)


@pytest.mark.parametrize("uv", [(32.2, 24.7), (5.5, 5.5), (60.1, 40.3), (33.0, 12.5)])
def test_pixel_to_skin_to_pixel(dented: PixelLink, uv: tuple[float, float]) -> None:
    """A pixel's place is seen by that pixel, dented skin and bent rays included."""
    place = dented.skin_at(np.array(uv))
    assert place is not None
    back = dented.pixel_of(place.place_mm)
    assert back.why == ""
    # The promise is a pixel; Newton's method ends at 1e-4 mm, a thousandth of one here.
    assert back.uv_px == pytest.approx(uv, abs=0.01)
    corners = dented.points_mm[dented.skin.faces[place.face]]
    assert place.weights @ corners == pytest.approx(place.place_mm, abs=1e-6)


def test_size_of_a_pixel_is_that_of_neighbours(dented: PixelLink) -> None:
    """A pixel at the middle is as wide as the way between the places of its two sides."""
    columns, rows = dented.mm_per_px(np.array([32.0, 24.0]))
    left, right = (dented.skin_at(np.array([32.0 + side, 24.0])) for side in (-0.5, 0.5))
    assert left is not None and right is not None
    assert columns == pytest.approx(np.linalg.norm(right.place_mm - left.place_mm))
    # The camera looks straight at the round tip: both ways alike, to the dent's facets.
    assert rows == pytest.approx(columns, rel=0.1)


def test_what_no_pixel_sees_says_why(dented: PixelLink) -> None:
    """A place beside the camera, low on the skin, is not in the picture of a narrow lens."""
    low = dented.points_mm[np.argmin(dented.points_mm[:, 2])]
    found = dented.pixel_of(low)
    assert found.why
    assert np.isnan(found.uv_px).all()


def test_a_look_takes_no_longer_than_a_click_may(dented: PixelLink) -> None:
    """Pixel, place, size and way back together: 0.2 s at most on a busy machine."""
    begun = time.perf_counter()
    place = dented.skin_at(np.array([30.0, 20.0]))
    assert place is not None
    dented.mm_per_px(np.array([30.0, 20.0]))
    dented.pixel_of(place.place_mm)
    assert time.perf_counter() - begun < 0.2
