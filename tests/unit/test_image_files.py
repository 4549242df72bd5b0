"""What `write_images` leaves in a run's folder."""

from __future__ import annotations

import csv
import dataclasses
import io
from pathlib import Path

import cv2
import numpy as np
import pytest

from workbench.core.result.sensing import Metrics, Shot, TactileFrames
from workbench.report.image_files import difference, field_bytes, png_bytes, write_images

HEIGHT, WIDTH, MARKERS = 12, 16, 2


def frames_of(count: int = 2, *, markers: int = MARKERS, seed: int = 1) -> TactileFrames:
    """A background and `count` images of noise; marker 1 is out of sight in the last."""
    random = np.random.default_rng(seed)
    shape = (count + 1, HEIGHT, WIDTH)
    steps = np.arange(count + 1)[:, None, None] * np.array([1.5, -0.5])
    uv = steps + np.array([[4.0, 5.0], [9.0, 6.0]])[:markers]
    if markers > 1:
        uv[-1, 1] = np.nan
    return TactileFrames(
        rgb=random.integers(0, 256, (*shape, 3), dtype=np.uint8),
        depth_z_mm=random.uniform(20.0, 40.0, shape).astype(np.float32),
        normal=random.normal(size=(*shape, 3)).astype(np.float16),
        moved=random.random(shape) < 0.5,
        marker_uv_px=uv.astype(np.float32),
        marker_mm=np.array([[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]])[:markers],
        exposure=0.7,
    )


def shot_of(*frames: TactileFrames) -> Shot:
    return Shot(frames=frames[0], metrics=Metrics(values={}), others=frames[1:])


def read(path: Path) -> np.ndarray:
    image = cv2.imread(str(path))
    assert image is not None
    return image[..., ::-1]


def test_a_png_holds_the_very_pixels() -> None:
    """Red stays red: encoded and decoded bytes are equal."""
    image = frames_of().rgb[0]
    data = np.frombuffer(png_bytes(image), dtype=np.uint8)
    decoded = cv2.imdecode(data, cv2.IMREAD_COLOR)
    assert decoded is not None and np.array_equal(decoded[..., ::-1], image)


def test_differences_are_doubled_about_middle_grey() -> None:
    """No change is 128; +10 is 148, -10 is 108; what leaves 0 to 255 is clipped."""
    background = np.full((1, 4, 3), 100, dtype=np.uint8)
    image = background.copy()
    image[0, 1:, 0] = (110, 90, 255)
    assert difference(image, background)[0, :, 0].tolist() == [128, 148, 108, 255]
    assert difference(image, background)[0, :, 1].tolist() == [128] * 4


def test_each_frame_has_its_image_difference_and_motion(tmp_path: Path) -> None:
    """Names in order; pixels as rendered; no fields unless they are asked for."""
    frames = frames_of()
    assert write_images(tmp_path, shot_of(frames)) == [
        "background.png",
        "frame_000.png",
        "frame_001.png",
    ]
    assert {path.name for path in tmp_path.iterdir()} == {
        "background.png",
        *(f"{kind}_{n:03d}.png" for kind in ("frame", "difference", "motion") for n in range(2)),
        "markers.csv",
    }
    assert np.array_equal(read(tmp_path / "frame_001.png"), frames.rgb[2])
    shown = difference(frames.rgb[2], frames.rgb[0])
    assert np.array_equal(read(tmp_path / "difference_001.png"), shown)


def test_the_table_of_markers_holds_places_and_motion(tmp_path: Path) -> None:
    """Motion is from the background; a marker out of sight has a place on the skin only."""
    write_images(tmp_path, shot_of(frames_of()))
    rows = list(csv.DictReader((tmp_path / "markers.csv").open()))
    assert [(row["frame"], row["marker"]) for row in rows] == [
        ("0", "0"),
        ("0", "1"),
        ("1", "0"),
        ("1", "1"),
    ]
    assert [float(rows[0][name]) for name in ("x_mm", "y_mm", "z_mm")] == [1.0, 2.0, 3.0]
    assert [float(rows[2][name]) for name in ("u_px", "v_px")] == [7.0, 4.0]
    assert [float(rows[2][name]) for name in ("du_px", "dv_px")] == [3.0, -1.0]
    assert [rows[3][name] for name in ("u_px", "v_px", "du_px", "dv_px")] == [""] * 4
    assert float(rows[3]["z_mm"]) == 6.0


def test_without_markers_there_is_no_motion(tmp_path: Path) -> None:
    """Neither arrows nor a table."""
    write_images(tmp_path, shot_of(frames_of(markers=0)))
    names = {path.name for path in tmp_path.iterdir()}
    assert "markers.csv" not in names and not any(name.startswith("motion") for name in names)


def test_fields_hold_what_every_pixel_sees(tmp_path: Path) -> None:
    """Depth, normals, masks, markers and exposure come back to the bit."""
    frames = frames_of()
    write_images(tmp_path, shot_of(frames), fields=True)
    with np.load(tmp_path / "frames.npz") as data:
        assert set(data.files) == {
            "depth_z_mm",
            "normal",
            "moved",
            "marker_uv_px",
            "marker_mm",
            "exposure",
        }
        for name in data.files:
            assert np.array_equal(data[name], getattr(frames, name), equal_nan=name != "moved")
    assert np.load(io.BytesIO(field_bytes(frames)))["depth_z_mm"].shape == (3, HEIGHT, WIDTH)


def test_further_cameras_have_folders(tmp_path: Path) -> None:
    """The second camera's images are in `camera_2`, the third's in `camera_3`."""
    all_frames = [frames_of(seed=seed) for seed in (1, 2, 3)]
    write_images(tmp_path, shot_of(*all_frames), fields=True)
    for number in (2, 3):
        folder = tmp_path / f"camera_{number}"
        assert np.array_equal(read(folder / "frame_000.png"), all_frames[number - 1].rgb[1])
        assert (folder / "frames.npz").exists() and (folder / "markers.csv").exists()


def test_images_of_a_longer_run_before_go(tmp_path: Path) -> None:
    """Three frames, then one without markers and with one camera: nothing old is left."""
    write_images(tmp_path, shot_of(frames_of(3), frames_of(3)), fields=True)
    write_images(tmp_path, shot_of(frames_of(1, markers=0)))
    assert sorted(str(path.relative_to(tmp_path)) for path in tmp_path.rglob("*.*")) == [
        "background.png",
        "difference_000.png",
        "frame_000.png",
    ]


def test_a_background_alone_is_written(tmp_path: Path) -> None:
    """No frames: one image."""
    frames = frames_of(0, markers=0)
    assert write_images(tmp_path, shot_of(frames)) == ["background.png"]
    assert dataclasses.astuple(frames)[0].shape[0] == 1
    assert [path.name for path in tmp_path.iterdir()] == ["background.png"]


@pytest.mark.parametrize("markers", [0, MARKERS])
def test_writing_twice_leaves_the_same_bytes(tmp_path: Path, markers: int) -> None:
    """PNG, CSV and NPZ alike."""
    found = []
    for _ in range(2):
        write_images(tmp_path, shot_of(frames_of(markers=markers)), fields=True)
        found.append({path.name: path.read_bytes() for path in tmp_path.iterdir()})
    assert found[0] == found[1]


def test_the_designers_own_files_stay(tmp_path: Path) -> None:
    """A photograph, notes and folders that no run wrote are left alone."""
    own = [tmp_path / "idle.png", tmp_path / "frame_best.png", tmp_path / "camera_raw" / "a.txt"]
    own += [tmp_path / "camera_2" / "notes.txt"]
    for path in own:
        path.parent.mkdir(exist_ok=True)
        path.write_bytes(b"mine")
    write_images(tmp_path, shot_of(frames_of(3), frames_of(3)))
    write_images(tmp_path, shot_of(frames_of(1)))
    assert all(path.read_bytes() == b"mine" for path in own)
    assert not (tmp_path / "camera_2" / "background.png").exists()


def test_the_folder_of_a_camera_that_is_gone_goes(tmp_path: Path) -> None:
    """A run with one camera leaves no empty folder of the second one of the run before."""
    write_images(tmp_path, shot_of(frames_of(1), frames_of(1)))
    write_images(tmp_path, shot_of(frames_of(1)))
    assert not (tmp_path / "camera_2").exists()
