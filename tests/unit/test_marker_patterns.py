"""Patterns of markers on a finger with known lengths, their messages, and their motion."""

from __future__ import annotations

import cv2
import numpy as np
import pytest
from scipy.spatial import KDTree

from sim.optics.proof.specimen import finger
from sim.optics.raster.marker_motion import draw_arrows, marker_motion
from sim.optics.raster.marker_patterns import (
    grid_places,
    pattern_places,
    picture_places,
    ring_places,
)
from sim.optics.raster.markers import place_markers
from workbench.core.base.errors import DesignError
from workbench.core.design.optics import MarkerPattern, Markers
from workbench.core.design.photo import Photo, photo
from workbench.core.result.results import Skin
from workbench.core.result.sensing import TactileFrames

RADIUS_MM, CYLINDER_MM = 15.0, 27.0
HEAT_MM = 0.15
"""Error of the heat method at edges of 0.8 mm: its order is one, and 0.5 mm err by 0.05 mm."""


@pytest.fixture(scope="module")
def skin() -> Skin:
    """Half sphere of radius 15 mm on a cylinder of 27 mm."""
    return finger(edge_mm=0.8).outer


def from_tip_mm(points: np.ndarray) -> np.ndarray:
    """Length of the meridian from the tip: R theta, then straight down."""
    across = np.hypot(points[:, 0], points[:, 1])
    theta = np.arctan2(across, points[:, 2] - CYLINDER_MM)
    below = np.maximum(CYLINDER_MM - points[:, 2], 0.0)
    return np.where(below > 0.0, RADIUS_MM * np.pi / 2 + below, RADIUS_MM * theta)


def test_rings_are_a_spacing_apart_along_the_skin(skin: Skin) -> None:
    """Circle k lies k spacings from the tip and has as many dots as spacings fit round it."""
    places = ring_places(skin, 4.0)
    ring = from_tip_mm(places) / 4.0
    assert np.abs(ring - np.round(ring)).max() * 4.0 < HEAT_MM
    number = np.round(ring).astype(int)
    assert set(number) == set(range(13))
    for k in range(1, 13):
        around = 2 * np.pi * RADIUS_MM * np.sin(min(k * 4.0 / RADIUS_MM, np.pi / 2))
        assert abs((number == k).sum() - around / 4.0) <= 0.6
        azimuth = np.degrees(np.arctan2(places[number == k, 1], places[number == k, 0]))
        assert np.abs(azimuth).min() < 3.0


def test_a_grid_is_straight_and_even_about_the_tip(skin: Skin) -> None:
    """Dot (i, j) lies s sqrt(i^2 + j^2) from the tip in the direction (i, j)."""
    places = grid_places(skin, 3.0)
    wanted = np.array([(3.0 * i, 3.0 * j) for i in range(-3, 4) for j in range(-3, 4)])
    azimuth = np.arctan2(places[:, 1], places[:, 0])
    flat = from_tip_mm(places)[:, None] * np.column_stack([np.cos(azimuth), np.sin(azimuth)])
    assert KDTree(flat).query(wanted)[0].max() < HEAT_MM


def test_dots_of_a_grid_never_crowd(skin: Skin) -> None:
    """Where columns draw together dots are left out: none nearer than 0.7 spacings."""
    places = grid_places(skin, 3.0)
    assert KDTree(places).query(places, 2)[0][:, 1].min() >= 0.7 * 3.0
    # Both rows and columns reach the base.
    assert places[:, 2].min() < 3.0


@pytest.mark.parametrize("pattern", [MarkerPattern.GRID, MarkerPattern.RINGS])
def test_dots_lie_on_the_skin(skin: Skin, pattern: MarkerPattern) -> None:
    """Within a chord's sagitta, 0.8^2 / (8 15) = 5e-3 mm, of the sphere and the cylinder."""
    places = place_markers(skin, Markers(visible=True, pattern=pattern, spacing_mm=4.0))
    centre = np.column_stack([np.zeros((len(places), 2)), np.minimum(places[:, 2], CYLINDER_MM)])
    centre[places[:, 2] > CYLINDER_MM, 2] = CYLINDER_MM
    assert np.abs(np.linalg.norm(places - centre, axis=1) - RADIUS_MM).max() < 0.02


def drawn(*dots: tuple[int, int], name: str = "dots.png") -> Photo:
    """A white picture of 200 x 100 pixels with black dots."""
    image = np.full((100, 200), 255, np.uint8)
    for dot in dots:
        cv2.circle(image, dot, 4, 0, -1)
    return photo(name, cv2.imencode(".png", image)[1].tobytes(), at="optics.markers.picture")


def test_a_picture_is_wrapped_from_above(skin: Skin) -> None:
    """20 mm wide, 0.1 mm a pixel: a dot 50 px right and 30 px up lies at x = 5, y = 3 mm."""
    places = picture_places(skin, drawn((100, 50), (150, 20)), 20.0)
    order = np.argsort(places[:, 0])
    assert places[order][:, :2] == pytest.approx(np.array([[0.05, -0.05], [5.05, 2.95]]), abs=1e-6)
    # Straight down onto the sphere, within a chord's sagitta.
    height = CYLINDER_MM + np.sqrt(RADIUS_MM**2 - 5.05**2 - 2.95**2)
    assert places[order][1, 2] == pytest.approx(height, abs=0.02)


def test_blobs_beside_the_skin_are_left_out(skin: Skin) -> None:
    """80 mm wide: a dot at x = 32 mm misses the finger of radius 15 mm."""
    assert len(picture_places(skin, drawn((100, 50), (180, 50)), 80.0)) == 1


@pytest.mark.parametrize(
    ("picture", "width_mm", "says", "at"),
    [
        (None, 30.0, "there is none", "optics.markers.picture"),
        (drawn(), 30.0, "dots.png has 0 dark blobs; a pattern has 1 to", "optics.markers.picture"),
        (
            drawn((190, 50)),
            200.0,
            "none of the 1 dark blobs of dots.png lies above the skin",
            "optics.markers.picture_mm",
        ),
    ],
)
def test_a_picture_without_a_pattern_is_refused(
    skin: Skin, picture: Photo | None, width_mm: float, says: str, at: str
) -> None:
    """The picture, what is in it, and what to do."""
    markers = Markers(
        visible=True, pattern=MarkerPattern.PICTURE, picture=picture, picture_mm=width_mm
    )
    with pytest.raises(DesignError) as caught:
        pattern_places(skin, markers)
    assert says in caught.value.message and caught.value.at == at and caught.value.hint


def moved(uv: list[list[list[float]]]) -> TactileFrames:
    """Frames of 40 x 60 pixels with markers at given places."""
    count = len(uv)
    return TactileFrames(
        rgb=np.zeros((count, 40, 60, 3), np.uint8),
        depth_z_mm=np.zeros((count, 40, 60), np.float32),
        normal=np.zeros((count, 40, 60, 3), np.float16),
        moved=np.zeros((count, 40, 60), bool),
        marker_uv_px=np.array(uv, np.float32),
        exposure=1.0,
    )


def test_motion_is_measured_from_the_background() -> None:
    """(10, 10) to (14, 13) is (4, 3); a marker that is hidden in either picture has none."""
    nan = float("nan")
    frames = moved([[[10, 10], [5, 5], [nan, nan]], [[14, 13], [nan, nan], [7, 7]]])
    motion = marker_motion(frames)
    assert motion.shape == (1, 3, 2)
    assert motion[0, 0].tolist() == [4.0, 3.0]
    assert np.isnan(motion[0, 1:]).all()


def test_arrows_are_drawn_where_markers_moved() -> None:
    """A way of 5 px at scale 4 reaches 20 px; the given picture is left alone."""
    frames = moved([[[10.0, 20.0], [40.0, 30.0]], [[15.0, 20.0], [40.0, 30.0]]])
    image = np.zeros((40, 60, 3), np.uint8)
    drawn_on = draw_arrows(image, frames, 1, scale=4.0)
    assert not image.any()
    columns = np.flatnonzero(drawn_on.max(axis=2).any(axis=0))
    # A line three pixels wide reaches up to two pixels beyond its ends.
    assert abs(columns.min() - 9.5) <= 2.5 and abs(columns.max() - 29.5) <= 2.5
    assert not drawn_on[28:33, 38:43].any()
    assert not draw_arrows(image, frames, 0).any()
