"""Photographs of a calibration in a project: checked as they come, kept, corrected, found again."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import cv2
import numpy as np
import pytest

from workbench.calibration.seen.photo_set import Circle, read_photo_set
from workbench.core.base.errors import DesignError
from workbench.photographs.calls import found_contact
from workbench.photographs.kept_photos import KeptPhotos, Use
from workbench.photographs.photo_files import folder_files, unpacked
from workbench.photographs.pictures import LEAST_PX, contact_picture
from workbench.project.design_bundle import zipped

SIZE = (60, 80)


def png(grey: int, size: tuple[int, int] = SIZE) -> bytes:
    return cv2.imencode(".png", np.full((*size, 3), grey, np.uint8))[1].tobytes()


def files(count: int = 5) -> dict[str, bytes]:
    return {"idle.png": png(100)} | {f"p{k}.png": png(110 + k) for k in range(count)}


def kept(tmp_path: Path, count: int = 5) -> KeptPhotos:
    found = KeptPhotos(tmp_path)
    found.take(files(count), 6.0)
    return found


def test_what_was_put_in_is_found_again(tmp_path: Path) -> None:
    """After a restart: circle, use and diameter; the command line reads the same folder."""
    first = kept(tmp_path, 7)
    circle = Circle(column_px=40.0, row_px=30.5, radius_px=8.0)
    first.put(*(dataclasses.replace(each, circle=circle, by_hand=True) for each in first.photos))
    one, two, *_ = first.photos
    first.put(dataclasses.replace(one, use=Use.LEAVE), dataclasses.replace(two, use=Use.HOLD))
    again = KeptPhotos(tmp_path)
    assert again.photos == first.photos and again.held_out == ("p1.png",)
    read = read_photo_set(again.folder, again.held_out)
    assert [each.name for each in read.photos] == [f"p{k}.png" for k in range(1, 7)]
    assert all(each.circle == circle and each.ball_mm == 6.0 for each in read.photos)


def test_a_file_of_another_size_leaves_the_set_as_it_was(tmp_path: Path) -> None:
    """It is named with both sizes, whether the idle photo or a ball comes later."""
    found = kept(tmp_path)
    with pytest.raises(DesignError, match=r"big\.png has 90 x 60 pixels, idle\.png 80 x 60"):
        found.take({"p8.png": png(1), "big.png": png(1, (60, 90))}, 6.0)
    with pytest.raises(DesignError, match=r"p0\.png has 80 x 60 pixels, idle\.png 90 x 60"):
        found.take({"idle.png": png(1, (60, 90))}, 6.0)
    with pytest.raises(DesignError, match=r"notes\.png \(3 bytes\) cannot be read"):
        found.take({"notes.png": b"abc"}, 6.0)
    assert len(found.photos) == 5 and not (found.folder / "p8.png").exists()
    assert found.image("idle.png").shape == (*SIZE, 3)


def test_a_table_says_what_is_known(tmp_path: Path) -> None:
    """Diameter, circle and depth by name; a word where a number belongs is named."""
    table = (
        b"photo,ball_mm,column_px,row_px,radius_px,depth_mm,pose_x_mm,pose_y_mm,pose_z_mm\n"
        b"p0.png,4,10,20,5,,,,\np1.png,,,,,.7,1.5,0,-2\n"
    )
    found = KeptPhotos(tmp_path)
    found.take(files() | {"presses.csv": table}, 6.0)
    one, two, *_ = found.photos
    assert (one.ball_mm, one.circle) == (4.0, Circle(column_px=10, row_px=20, radius_px=5))
    assert (two.ball_mm, two.circle, two.depth_mm) == (6.0, None, 0.7)
    assert (one.place_mm, two.place_mm) == (None, (1.5, 0.0, -2.0))
    assert KeptPhotos(tmp_path).photos == found.photos
    with pytest.raises(DesignError, match=r"p1\.png: depth_mm is deep, not a number"):
        found.take({"presses.csv": b"photo,depth_mm\np1.png,deep\n"}, 6.0)
    with pytest.raises(DesignError, match=r"p1\.png has a pose without pose_y_mm"):
        found.take({"presses.csv": b"photo,pose_x_mm,pose_y_mm,pose_z_mm\np1.png,1,,2\n"}, 6.0)
    with pytest.raises(DesignError, match=r"p1\.png has a circle without radius_px"):
        found.take({"presses.csv": b"photo,column_px,row_px\np1.png,1,2\n"}, 6.0)
    assert KeptPhotos(tmp_path).photos == found.photos


def test_a_circle_that_was_found_is_not_one_that_was_drawn(tmp_path: Path) -> None:
    """The table has the drawn one alone: what is found may be too small by more."""
    found = kept(tmp_path)
    circle = Circle(column_px=40.0, row_px=30.5, radius_px=8.0)
    one = found.photos[0]
    found.put(*(dataclasses.replace(each, circle=circle) for each in found.photos))
    found.put(dataclasses.replace(one, circle=circle, by_hand=True))
    read = read_photo_set(found.folder)
    assert [each.circle for each in read.photos] == [circle, None, None, None, None]


def test_what_a_calibration_lacks_is_said(tmp_path: Path) -> None:
    """An idle photo, then photographs, then contacts."""
    found = KeptPhotos(tmp_path)
    found.take({"p0.png": png(1)}, 6.0)
    with pytest.raises(DesignError, match="no idle photo"):
        found.expect_ready()
    found.take({"idle.jpg": png(1)}, 6.0)
    with pytest.raises(DesignError, match="1 photographs to fit to are fewer than 5"):
        found.expect_ready()
    found.take(files(), 6.0)
    with pytest.raises(DesignError, match=r"p0\.png, .*p4\.png: no contact is known"):
        found.expect_ready()


def test_archives_and_folders_are_unpacked(tmp_path: Path) -> None:
    """Folders inside are left out, as is what a system adds; a folder lies in the project."""
    data = {"set/idle.png": png(1), "__MACOSX/set/._idle.png": b"", "set/.x.png": b"", "a.txt": b""}
    assert list(unpacked("set.zip", zipped(data))) == ["idle.png"]
    with pytest.raises(DesignError, match="holds no photographs"):
        unpacked("set.zip", zipped({"a.txt": b""}))
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "idle.png").write_bytes(png(1))
    assert list(folder_files(tmp_path.resolve(), "mine")) == ["idle.png"]
    for typed in ("..", "", "other", "/etc"):
        with pytest.raises(DesignError, match="no folder"):
            folder_files(tmp_path.resolve(), typed)


def test_a_photograph_without_a_contact_says_so() -> None:
    """Noise holds nothing up; a circle that is known is kept, and a brighter exposure told."""
    rng = np.random.default_rng(0)
    idle = rng.integers(60, 120, (120, 160, 3)).astype(np.uint8)
    noise = (idle + rng.integers(0, 6, idle.shape)).astype(np.uint8)
    assert "shows no contact" in found_contact("p.png", noise, idle, None).reason
    circle = Circle(column_px=80, row_px=60, radius_px=10)
    found = found_contact("p.png", (idle * 1.5).astype(np.uint8), idle, circle)
    assert found.circle == circle
    assert found.drift.gain == pytest.approx(1.5, abs=0.02)


def test_the_circle_is_drawn_where_it_is() -> None:
    """Yellow on its line, 80 px enlarged to the page's width; elsewhere the photograph."""
    grey = np.full((*SIZE, 3), 90, np.uint8)
    shown = contact_picture(grey, Circle(column_px=40.0, row_px=30.0, radius_px=10.0))
    scale = LEAST_PX / SIZE[1]
    assert shown.shape == (SIZE[0] * scale, LEAST_PX, 3)
    middle, edge = round(30.5 * scale - 0.5), round(50.5 * scale - 0.5)
    assert shown[middle, edge - 1 : edge + 2, 0].max() > 200
    assert (shown[:20] == 90).all() and (grey == 90).all()


def test_put_away_keeps_the_set(tmp_path: Path) -> None:
    """Beside, under another name."""
    found = kept(tmp_path)
    where = found.put_away()
    assert where is not None and (where / "photos" / "p0.png").is_file()
    assert not found.photos and not KeptPhotos(tmp_path).photos and not found.has_idle
