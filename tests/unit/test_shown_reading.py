"""What the page makes of a reading, and where its photographs come from."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import cv2
import numpy as np
import pytest

from workbench.core.base.errors import DesignError
from workbench.core.result.results import Skin
from workbench.reading.camera_frames import IDLE_FRAMES, CameraFrames
from workbench.reading.kept_readings import IDLE, KeptReadings
from workbench.reading.shown_reading import LEAST_MM, Look, ShownReading, Told
from workbench.report.image_files import png_bytes
from workbench.view.colour_scale import NOTHING_GREY, YES

ROWS, COLUMNS = 20, 30
PIXEL_MM = 0.5


@pytest.fixture
def found() -> ShownReading:
    """A plane of half a millimetre a pixel, deeper to the right; the last column sees no skin."""
    row, column = np.mgrid[:ROWS, :COLUMNS].astype(float)
    place_mm = np.stack([PIXEL_MM * column, PIXEL_MM * row, 0.0 * row], axis=2)
    depth_mm = 0.01 * column
    depth_mm[:, -1] = place_mm[:, -1] = np.nan
    corners = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    told = Told(pixels=depth_mm, vertices=np.array([0.0, 0.4, np.nan]))
    yes = Told(pixels=(depth_mm > 0.1).astype(float), vertices=np.array([0.0, 1.0, 0.0]))
    return ShownReading(
        name="p.png",
        image=np.zeros((ROWS, COLUMNS, 3), dtype=np.uint8),
        figures={},
        skin=Skin(points_mm=corners, faces=np.array([[0, 1, 2]]), normals=np.eye(3)),
        place_mm=place_mm,
        told={Look.DEPTH: told, Look.TILT: told, Look.DEVIATION: told, Look.CONTACT: yes},
    )


def test_a_profile_is_measured_along_the_skin(found: ShownReading) -> None:
    """Ten pixels of half a millimetre and 30 pixels aslant; where no skin is seen it ends."""
    way, depth = found.profile((2, 5), (12, 5))
    assert way[-1] == pytest.approx(10 * PIXEL_MM)
    np.testing.assert_allclose(depth, 0.01 * np.arange(2, 13))
    way, depth = found.profile((0, 0), (COLUMNS - 1, ROWS - 1))
    assert way[-1] == pytest.approx(PIXEL_MM * np.hypot(COLUMNS - 2, ROWS - 2), rel=0.15)
    assert depth[-1] == pytest.approx(0.01 * (COLUMNS - 2))


def test_a_profile_goes_the_way_it_was_drawn(found: ShownReading) -> None:
    """From the right to the left it falls; a line within what sees no skin says nothing."""
    _, depth = found.profile((12, 5), (2, 5))
    assert (np.diff(depth) < 0.0).all()
    assert found.profile((COLUMNS - 1, 0), (COLUMNS - 1, 9)).shape == (2, 0)


def test_unknown_places_are_grey_and_contact_is_yes_or_no(found: ShownReading) -> None:
    """In pictures and on the skin."""
    assert (found.picture(Look.DEPTH)[:, -1] == NOTHING_GREY).all()
    assert (found.skin_colours(Look.DEPTH)[2] == NOTHING_GREY).all()
    assert (found.picture(Look.CONTACT)[0, 20] == YES).all()
    assert (found.picture(Look.CONTACT)[0, 3] == NOTHING_GREY).all()
    assert found.picture(Look.PHOTO) is found.image


def test_colours_end_at_the_largest_value_or_at_a_least_one(found: ShownReading) -> None:
    """A touch of nothing is not drawn as a deep one."""
    scale = found.scale(Look.DEPTH)
    assert scale is not None
    assert scale.high == pytest.approx(0.4)
    flat = Told(pixels=np.zeros((ROWS, COLUMNS)), vertices=np.zeros(3))
    scale = dataclasses.replace(found, told={Look.DEPTH: flat}).scale(Look.DEPTH)
    assert scale is not None
    assert scale.high == LEAST_MM


def grey(rows: int, columns: int) -> bytes:
    return png_bytes(np.full((rows, columns, 3), 90, dtype=np.uint8))


def test_photographs_of_one_size_are_kept(tmp_path: Path) -> None:
    """All of an upload or none; `Idle.PNG` is the one at rest."""
    kept = KeptReadings(tmp_path)
    assert kept.take({"Idle.PNG": grey(6, 8), "b.png": grey(6, 8)}) == ("b.png",)
    with pytest.raises(DesignError, match="8 x 7 pixels"):
        kept.take({"a.png": grey(6, 8), "c.png": grey(7, 8)})
    assert kept.photos == ("b.png",)
    assert kept.has_idle
    assert kept.image(IDLE).shape == (6, 8, 3)
    assert kept.put_away() is not None
    assert kept.photos == ()


def test_a_video_of_the_project_gives_its_frames(tmp_path: Path) -> None:
    """The mean of the first eight, then the others, then none."""
    path = tmp_path / "v.avi"
    video = cv2.VideoWriter(str(path), cv2.VideoWriter.fourcc(*"FFV1"), 10.0, (16, 12))
    for number in range(IDLE_FRAMES + 1):
        video.write(np.full((12, 16, 3), (10 * number, 0, 0), dtype=np.uint8))
    video.release()
    frames = CameraFrames("v.avi", tmp_path)
    assert frames.mean()[0, 0].tolist() == pytest.approx([0, 0, 35], abs=1)
    last = frames.next()
    assert last is not None
    assert last[0, 0].tolist() == pytest.approx([0, 0, 10 * IDLE_FRAMES], abs=1)
    assert frames.next() is None


@pytest.mark.parametrize("typed", ["", "none.avi", "../v.avi", "/etc/hostname"])
def test_files_outside_the_project_are_refused(tmp_path: Path, typed: str) -> None:
    """Before anything is opened, with what may be typed."""
    with pytest.raises(DesignError, match="no video") as refused:
        CameraFrames(typed, tmp_path)
    assert "number of a camera" in (refused.value.hint or "")
