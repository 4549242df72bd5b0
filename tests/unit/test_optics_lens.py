"""Distorted lenses against OpenCV, their inverse, and the distortions that are refused."""

from __future__ import annotations

import math

import cv2
import numpy as np
import pytest

from sim.optics.camera.camera import focal_px, pixel_centres, pixel_directions, project, unproject
from sim.optics.camera.lens import lens_of
from sim.optics.proof.checks import edge_angle_error_deg, round_trip_px
from workbench.core.base.errors import DesignError
from workbench.core.design.camera import Camera, LensModel

ORIGIN = (0.0, 0.0, 0.0)
BARREL = (-0.12, 0.01, 0.0012, -0.0008, 0.001)
FISHEYE = (0.05, -0.02, 0.004, -0.0005)


def bent(lens: LensModel, distortion: tuple[float, ...], fov_x_deg: float) -> Camera:
    """A camera at the origin that looks along +Z."""
    return Camera(lens=lens, distortion=distortion, fov_x_deg=fov_x_deg, position_mm=ORIGIN)


CAMERAS = (
    bent(LensModel.OPENCV, BARREL, 100.0),
    bent(LensModel.OPENCV, BARREL[:4], 80.0),
    bent(LensModel.OPENCV, (0.2, 0.05, 0.0, 0.0), 90.0),
    bent(LensModel.OPENCV, (0.0, 0.0, 0.002, 0.001), 60.0),
    bent(LensModel.OPENCV_FISHEYE, FISHEYE, 180.0),
    bent(LensModel.OPENCV_FISHEYE, FISHEYE, 120.0),
)


def opencv_px(camera: Camera, points: np.ndarray) -> np.ndarray:
    """Where OpenCV itself sees the points."""
    f = focal_px(camera)
    matrix = np.array(
        [[f, 0.0, camera.width_px / 2], [0.0, f, camera.height_px / 2], [0.0, 0.0, 1.0]]
    )
    still = np.zeros(3)
    distortion = np.array(camera.distortion)
    if camera.lens is LensModel.OPENCV:
        return cv2.projectPoints(points, still, still, matrix, distortion)[0][:, 0]
    return cv2.fisheye.projectPoints(points[:, None], still, still, matrix, distortion)[0][:, 0]


@pytest.mark.parametrize("camera", CAMERAS)
def test_projection_is_that_of_opencv(camera: Camera) -> None:
    """Equal to 1e-6 px at points over the whole image."""
    directions = pixel_directions(camera, pixel_centres(camera)[::97])
    points = directions[directions[:, 2] > 0.05] * 20.0
    assert np.abs(project(camera, points) - opencv_px(camera, points)).max() < 1e-6


@pytest.mark.parametrize("camera", CAMERAS)
def test_distorted_round_trip(camera: Camera) -> None:
    """Pixel to point to pixel is the identity to 1e-3 px, 40 px outside the image as well."""
    columns, rows = np.meshgrid(np.arange(-40, 681, 3.0), np.arange(-40, 521, 3.0))
    pixels = np.column_stack([columns.ravel(), rows.ravel()])
    points = unproject(camera, pixels, range_mm=np.full(len(pixels), 20.0))
    assert np.abs(project(camera, points) - pixels).max() < 1e-3


@pytest.mark.parametrize("camera", CAMERAS)
def test_field_of_view_holds_with_distortion(camera: Camera) -> None:
    """The half width is f r(fov / 2): the middle of the left edge is fov / 2 off the axis."""
    half = math.radians(camera.fov_x_deg / 2)
    t = half if camera.lens is LensModel.OPENCV_FISHEYE else math.tan(half)
    reach = lens_of(camera).radius(np.array([t]))[0]
    assert focal_px(camera) * reach == pytest.approx(camera.width_px / 2)


@pytest.mark.parametrize("lens", list(LensModel))
def test_checks_of_the_validation_hold(lens: LensModel) -> None:
    """The rows of `workbench validate optics`: round trip 1e-3 px, edges 1e-6 degree."""
    assert round_trip_px(lens) < 1e-3
    assert edge_angle_error_deg(lens) < 1e-6


def test_points_outside_the_image_do_not_fold_back() -> None:
    """Beyond the fold of r = t - 0.1 t^3 at t = 1.83 the radius still grows."""
    camera = bent(LensModel.OPENCV, (-0.1, 0.0, 0.0, 0.0), 60.0)
    t = np.linspace(0.0, 6.0, 200)
    points = np.column_stack([t, np.zeros(200), np.ones(200)])
    columns = project(camera, points)[:, 0]
    assert (np.diff(columns) > 0.0).all()


@pytest.mark.parametrize(
    ("camera", "fold_px"),
    [
        # r = t - 0.5 t^3 turns at t = sqrt(2 / 3) = 0.816, before the edge at tan 50 = 1.192.
        (bent(LensModel.OPENCV, (-0.5, 0.0, 0.0, 0.0), 100.0), 0.5443 / 1.1918 * 320),
        # r = t - 0.15 t^3 turns at 1.491, between edge (r = 0.938) and corner (r = 1.172).
        (bent(LensModel.OPENCV, (-0.15, 0.0, 0.0, 0.0), 100.0), 0.9938 / 0.9378 * 320),
        (bent(LensModel.OPENCV_FISHEYE, (-0.3, 0.0, 0.0, 0.0), 180.0), 0.7027 / 1.5708 * 320),
    ],
)
def test_folding_distortion_is_refused(camera: Camera, fold_px: float) -> None:
    """The message gives the distance of the fold from the centre; the curve's turning point."""
    with pytest.raises(DesignError) as caught:
        pixel_directions(camera, np.array([[320.0, 240.0]]))
    assert caught.value.at == "optics.camera.distortion" and caught.value.hint
    assert f"folds the image {fold_px:.0f} px from its centre" in caught.value.message
    assert "400 px to its corner" in caught.value.message


def test_tangential_fold_is_refused() -> None:
    """p1 = 0.5 gives det J = (1 + y) (1 + 3 y) on x = 0, which is 0 at y = -1/3."""
    camera = bent(LensModel.OPENCV, (0.0, 0.0, 0.5, 0.0), 100.0)
    with pytest.raises(DesignError, match="folds the image"):
        focal_px(camera)


def test_wrong_count_of_coefficients_is_refused() -> None:
    """Three coefficients fit no lens; a pinhole takes none."""
    with pytest.raises(DesignError, match="takes 4 or 5 distortion coefficients, not 3") as caught:
        Camera(lens=LensModel.OPENCV, distortion=(0.1, 0.2, 0.3))
    assert caught.value.at == "optics.camera.distortion"
    with pytest.raises(DesignError, match="pinhole takes no distortion"):
        Camera(distortion=(0.1, 0.0, 0.0, 0.0))


@pytest.mark.parametrize("camera", [c for c in CAMERAS if c.lens is LensModel.OPENCV])
@pytest.mark.parametrize("share", [0.3, 0.9, 1.4])
def test_the_jacobian_is_the_derivative_of_bend(camera: Camera, share: float) -> None:
    """Central differences of 1e-6 about places within the limit, and beyond it."""
    lens = lens_of(camera)
    turn = np.linspace(0.1, 6.2, 17)
    reach = min(lens.limit, 3.0)
    ideal = share * reach * np.column_stack([np.cos(turn), np.sin(turn)])
    found = lens.jacobian(ideal)
    step = 1e-6
    for axis in (0, 1):
        aside = step * np.eye(2)[axis]
        slope = (lens.bend(ideal + aside) - lens.bend(ideal - aside)) / (2.0 * step)
        # Second differences of a fifth-order polynomial: 1e-9, rounding 1e-10.
        np.testing.assert_allclose(found[:, :, axis], slope, atol=1e-7)
