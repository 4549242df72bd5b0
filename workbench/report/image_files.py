"""The images of a run: backgrounds, frames, differences, marker motion, and fields of pixels."""

from __future__ import annotations

import contextlib
import io
from pathlib import Path

import numpy as np

from workbench.core.result.sensing import Shot, TactileFrames
from workbench.system.folder import CAMERA_FILES, IMAGE_FILES, remove_stale
from workbench.system.whole_files import write_atomically

FIELDS = "frames.npz"
DIFFERENCE_GAIN = 2.0
"""Differences are drawn twice as strong about middle grey."""


def png_bytes(rgb: np.ndarray) -> bytes:
    """An image (H, W, 3) uint8 sRGB as a PNG file."""
    import cv2

    return cv2.imencode(".png", np.ascontiguousarray(rgb[..., ::-1]))[1].tobytes()


def difference(image: np.ndarray, background: np.ndarray) -> np.ndarray:
    """Change against the background about middle grey, twice as strong, (H, W, 3) uint8."""
    change = image.astype(np.float32) - background
    return np.clip(np.round(128.0 + DIFFERENCE_GAIN * change), 0, 255).astype(np.uint8)


def write_images(out: Path, shot: Shot, *, fields: bool = False) -> list[str]:
    """Write `background.png`, `frame_000.png` ... of the camera; returns their names in order.

    Beside them `difference_000.png` ..., with markers `motion_000.png` ... and `markers.csv`, and
    with `fields` what each pixel sees as `frames.npz`; of a further camera the same in `camera_2`.
    """
    names = _write_camera(out, shot.frames, fields=fields)
    remove_stale(out, CAMERA_FILES, keep=())
    for folder in out.glob("camera_[2-8]"):
        with contextlib.suppress(OSError):
            # Not empty: it holds something of the designer's.
            folder.rmdir()
    for number, frames in enumerate(shot.others, start=2):
        _write_camera(out / f"camera_{number}", frames, fields=fields)
    return names


def _write_camera(out: Path, frames: TactileFrames, *, fields: bool) -> list[str]:
    names = ["background.png", *(f"frame_{k:03d}.png" for k in range(len(frames.rgb) - 1))]
    files = {name: png_bytes(rgb) for name, rgb in zip(names, frames.rgb, strict=True)}
    for number, image in enumerate(frames.rgb[1:]):
        files[f"difference_{number:03d}.png"] = png_bytes(difference(image, frames.rgb[0]))
    if frames.marker_uv_px.shape[1]:
        files |= _marker_files(frames)
    if fields:
        files[FIELDS] = field_bytes(frames)
    remove_stale(out, IMAGE_FILES, keep=files)
    for name, content in files.items():
        write_atomically(out / name, content)
    return names


def field_bytes(frames: TactileFrames) -> bytes:
    """What each pixel of each image sees, background first, as an NPZ file."""
    buffer = io.BytesIO()
    np.savez_compressed(
        buffer,
        depth_z_mm=frames.depth_z_mm,
        normal=frames.normal,
        moved=frames.moved,
        marker_uv_px=frames.marker_uv_px,
        marker_mm=frames.marker_mm,
        exposure=frames.exposure,
    )
    return buffer.getvalue()


def _marker_files(frames: TactileFrames) -> dict[str, bytes]:
    """Arrows of the markers' motion over each image, and the motion as a table."""
    from sim.optics.raster.marker_motion import draw_arrows, marker_motion

    moved = marker_motion(frames)
    files = {
        f"motion_{number:03d}.png": png_bytes(draw_arrows(image, frames, number + 1))
        for number, image in enumerate(frames.rgb[1:])
    }
    lines = ["frame,marker,x_mm,y_mm,z_mm,u_px,v_px,du_px,dv_px"]
    for number in range(1, len(frames.rgb)):
        for marker, place in enumerate(frames.marker_mm):
            uv, by = frames.marker_uv_px[number, marker], moved[number - 1, marker]
            # A marker that the camera does not see has a place on the skin but none in the image.
            seen = [f"{value:.4f}" if np.isfinite(value) else "" for value in (*uv, *by)]
            cells = [str(number - 1), str(marker), *(f"{x:.4f}" for x in place), *seen]
            lines.append(",".join(cells))
    return files | {"markers.csv": ("\n".join(lines) + "\n").encode()}
