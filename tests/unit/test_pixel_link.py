"""Pixel to skin and back: the ray of the renderer, and a round trip of a hundredth of a pixel."""

from __future__ import annotations

import dataclasses
import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from sim.optics.camera.camera import refracted_rays
from workbench.core.design.camera import Camera
from workbench.core.design.optics import Optics
from workbench.core.result.results import MembraneMesh, Skin
from workbench.view.pixel_link import PixelLink, frame_link
from workbench.view.scene_shapes import first_hit

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


@pytest.mark.parametrize("uv", [(32.0, 24.0), (9.5, 40.5)])
def test_size_of_a_pixel_on_a_flat_skin(uv: tuple[float, float]) -> None:
    """A pinhole above a plane at 20 mm: 20 / f with f = 32 px / tan(fov / 2), for every pixel."""
    corners = np.array([(-50.0, -50.0), (50.0, -50.0), (50.0, 50.0), (-50.0, 50.0)])
    faces = np.array([[0, 1, 2], [0, 2, 3]])
    height = np.full((4, 1), OPTICS.camera.position_mm[2] + 20.0)
    up = np.tile([0.0, 0.0, 1.0], (4, 1))
    flat = Skin(points_mm=np.hstack([corners, height]), faces=faces, normals=up)
    mesh: Any = SimpleNamespace(seen=flat, cavity=flat)
    air = dataclasses.replace(OPTICS, refractive_index=1.0)
    link = PixelLink(mesh, air, air.camera, np.zeros((4, 3)))
    focal_px = 32.0 / math.tan(math.radians(air.camera.fov_x_deg / 2.0))
    # The intersections of two rays with a plane: rounding alone.
    assert link.mm_per_px(np.array(uv)) == pytest.approx((20.0 / focal_px,) * 2, rel=1e-9)


def test_the_round_tip_has_pixels_of_equal_sides(dented: PixelLink) -> None:
    """The camera looks straight at it: columns and rows alike."""
    columns, rows = dented.mm_per_px(np.array([32.0, 24.0]))
    # A dent of 1 mm in 3 mm, drawn in facets as wide as a few pixels.
    assert rows == pytest.approx(columns, rel=0.1)


def test_what_no_pixel_sees_says_why(dented: PixelLink) -> None:
    """A place beside the camera, low on the skin, is not in the image of a narrow lens."""
    low = dented.points_mm[np.argmin(dented.points_mm[:, 2])]
    found = dented.pixel_of(low)
    assert found.why
    assert np.isnan(found.uv_px).all()


def test_a_look_casts_few_rays(dented: PixelLink, monkeypatch: pytest.MonkeyPatch) -> None:
    """Place and size take ten rays, and the way back a few steps: they are what a click costs."""
    rays = 0

    def counted(*words: Any, **named: Any) -> Any:
        nonlocal rays
        rays += 1
        return first_hit(*words, **named)

    monkeypatch.setattr("workbench.view.pixel_link.first_hit", counted)
    place = dented.skin_at(np.array([30.0, 20.0]))
    assert place is not None
    dented.mm_per_px(np.array([30.0, 20.0]))
    assert rays == 2 + 4 * 2
    dented.pixel_of(place.place_mm)
    # Four steps of Newton's method are usual, each of one ray and four for its slopes; then two
    # rays to see that it has arrived, and three for what may hide the place.
    assert rays <= 10 + 4 * 5 + 2 + 3
