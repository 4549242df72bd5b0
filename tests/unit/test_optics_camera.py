"""Pixels and rays against the closed forms of the two lenses and of Snell and Fresnel."""

from __future__ import annotations

import math

import numpy as np
import pytest

from sim.optics.camera.camera import (
    depth_z,
    focal_px,
    pixel_centres,
    pixel_directions,
    project,
    refracted_rays,
    unproject,
)
from sim.optics.camera.refraction import refract
from sim.optics.proof.specimen import finger
from workbench.core.design.camera import Camera, LensModel

TURN_X_90 = (math.sqrt(0.5), math.sqrt(0.5), 0.0, 0.0)
ROUNDING = 1e-12
"""Double precision loses a few units of 2e-16 in ten operations on numbers up to 1000."""


@pytest.mark.parametrize("lens", list(LensModel))
def test_project_inverts_unproject(lens: LensModel) -> None:
    """Pixel to point to pixel is the identity; asked for 1e-3 px, double precision gives 1e-9."""
    camera = Camera(lens=lens, position_mm=(1.0, -2.0, 3.0), wxyz=TURN_X_90)
    centres = pixel_centres(camera)
    points = unproject(camera, centres, range_mm=np.linspace(1.0, 60.0, len(centres)))
    assert np.abs(project(camera, points) - centres).max() < 1e-9


def test_pinhole_edge_is_at_half_the_field_of_view() -> None:
    """f = W / (2 tan(fov / 2)): the point (tan(fov / 2), 0, 1) lands on u = W, v = H / 2."""
    camera = Camera(fov_x_deg=100.0, position_mm=(0.0, 0.0, 0.0))
    assert focal_px(camera) == pytest.approx(640 / (2 * math.tan(math.radians(50))))
    edge = np.array([[math.tan(math.radians(50)), 0.0, 1.0]])
    assert project(camera, edge) == pytest.approx(np.array([[640.0, 240.0]]))


def test_equidistant_radius_grows_with_the_angle() -> None:
    """r = f theta with f = W / fov: 45 degrees of a 180 degree lens is a quarter of the width."""
    camera = Camera(lens=LensModel.EQUIDISTANT, fov_x_deg=180.0, position_mm=(0.0, 0.0, 0.0))
    assert project(camera, np.array([[1.0, 0.0, 1.0]]))[0] == pytest.approx([320 + 160, 240])
    assert project(camera, np.array([[-1.0, 0.0, 0.0]]))[0] == pytest.approx([0.0, 240])


def test_pixels_are_square() -> None:
    """Equal angles to the right and down are equal pixel distances in a 640 x 480 image."""
    for lens in LensModel:
        camera = Camera(lens=lens, position_mm=(0.0, 0.0, 0.0))
        right, down = project(camera, np.array([[0.3, 0.0, 1.0], [0.0, 0.3, 1.0]]))
        assert right[0] - 320 == pytest.approx(down[1] - 240)


def test_identity_camera_has_the_sensor_axes() -> None:
    """(1, 0, 0, 0) looks along +Z with sensor +X to the right and sensor +Y down."""
    camera = Camera(position_mm=(0.0, 0.0, 0.0))
    points = np.array([[1.0, 0.0, 10.0], [0.0, 1.0, 10.0]])
    (u_x, v_x), (u_y, v_y) = project(camera, points)
    assert u_x > 320 and v_x == pytest.approx(240)
    assert u_y == pytest.approx(320) and v_y > 240


def test_quaternion_turns_the_camera_to_the_sensor() -> None:
    """+90 degrees about X turns the optical axis from +Z to -Y."""
    camera = Camera(wxyz=TURN_X_90)
    assert pixel_directions(camera, np.array([[320.0, 240.0]]))[0] == pytest.approx([0, -1, 0])


def test_depth_z_is_not_the_range() -> None:
    """(3, 0, 4) from the camera has depth_z 4 and range 5."""
    camera = Camera(position_mm=(0.0, 0.0, 1.0))
    point = np.array([[3.0, 0.0, 5.0]])
    assert depth_z(camera, point)[0] == pytest.approx(4.0)
    assert unproject(camera, project(camera, point), range_mm=np.array([5.0])) == pytest.approx(
        point
    )


def test_a_point_behind_a_pinhole_has_no_pixel() -> None:
    """Its projection is NaN, not the mirrored pixel."""
    assert np.isnan(project(Camera(), np.array([[1.0, 0.0, -5.0]]))).all()


def test_snell_bends_30_degrees_into_silicone_to_20_77_degrees() -> None:
    """asin(sin 30 / 1.41) = 20.7695 degrees."""
    slanted = np.array([[0.5, 0.0, math.sqrt(0.75)]])
    bent, _ = refract(slanted, np.array([[0.0, 0.0, 1.0]]), index_from=1.0, index_to=1.41)
    assert math.degrees(math.asin(bent[0, 0])) == pytest.approx(20.7695, abs=1e-4)
    assert np.linalg.norm(bent) == pytest.approx(1.0, abs=ROUNDING)


def test_fresnel_passes_97_percent_straight_into_silicone() -> None:
    """T = 4 n / (1 + n)^2 = 0.97106 for n = 1.41."""
    up = np.array([[0.0, 0.0, 1.0]])
    _, transmittance = refract(up, up, index_from=1.0, index_to=1.41)
    assert transmittance[0] == pytest.approx(4 * 1.41 / 2.41**2, abs=ROUNDING)


def test_fresnel_at_brewster_reflects_one_polarisation_only() -> None:
    """At tan a = n, Rp = 0 and Rs = ((n^2 - 1) / (n^2 + 1))^2, so T = 1 - Rs / 2."""
    angle = math.atan(1.41)
    direction = np.array([[math.sin(angle), 0.0, math.cos(angle)]])
    _, got = refract(direction, np.array([[0.0, 0.0, 1.0]]), index_from=1.0, index_to=1.41)
    assert got[0] == pytest.approx(1 - 0.5 * ((1.41**2 - 1) / (1.41**2 + 1)) ** 2, abs=ROUNDING)


def test_nothing_leaves_beyond_the_critical_angle() -> None:
    """asin(1 / 1.41) = 45.17 degrees: at 45 light leaves silicone, at 46 it does not."""
    angle = np.radians([45.0, 46.0])
    direction = np.column_stack([np.sin(angle), 0 * angle, np.cos(angle)])
    normal = np.tile([0.0, 0.0, 1.0], (2, 1))
    _, transmittance = refract(direction, normal, index_from=1.41, index_to=1.0)
    assert transmittance[0] > 0.3
    assert transmittance[1] == 0.0


def test_index_one_leaves_rays_straight() -> None:
    """No wall at n = 1: rays start at the camera, unbent and undimmed."""
    camera = Camera(width_px=32, height_px=24)
    rays = refracted_rays(camera, finger(edge_mm=2.0).cavity, 1.0)
    straight = pixel_directions(camera, pixel_centres(camera)).astype(np.float32)
    assert np.array_equal(rays.direction, straight)
    assert (rays.origin_mm == np.float32([0.0, 0.0, 0.3])).all()
    assert (rays.transmittance == 1.0).all()


def test_rays_from_the_centre_of_the_tip_sphere_are_not_bent() -> None:
    """They meet the wall along its normal: directions unchanged, T = 4 n / (1 + n)^2."""
    camera = Camera(width_px=64, height_px=48, fov_x_deg=90.0, position_mm=(0.0, 0.0, 27.0))
    rays = refracted_rays(camera, finger(edge_mm=0.5).cavity, 1.41)
    straight = pixel_directions(camera, pixel_centres(camera))
    # Smooth normals err by the square of half an edge over the radius: (0.25 / 12)^2 = 4e-4.
    assert np.abs(rays.direction - straight).max() < 4e-4
    assert rays.transmittance == pytest.approx(4 * 1.41 / 2.41**2, abs=1e-4)
