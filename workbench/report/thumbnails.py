"""Thumbnails of variants: the membrane at rest, pressed, and its tactile image, side by side.

The membrane is drawn by two stages of the `cad` worker, found again by what they draw; they belong
to no plan of a design, because nothing but a list needs them. The tiles are put together here.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from workbench.pipeline.stage import Call, Ref
from workbench.pipeline.stages import portrait, portrait_pressed
from workbench.pipeline.store import Store
from workbench.report.image_files import png_bytes

TILE_PX = 160
TILES = (portrait.STAGE.name, portrait_pressed.STAGE.name, "shoot")
"""What stands in a thumbnail, from the left."""
GROUND = (244, 243, 241)
"""Behind the membrane: the same in the dark front and in printed reports."""


def thumbnail_calls(store: Store, keys: Mapping[str, str]) -> tuple[Call, ...]:
    """The drawings that can be made of the stored results with these keys, by stage."""
    there: dict[str, Any] = {
        stage: Ref(stage=stage, key=key) for stage, key in keys.items() if store.has(stage, key)
    }
    calls = []
    if "build" in there:
        calls.append(portrait.STAGE.call(portrait.ThumbnailInputs(solid=there["build"])))
    if "mesh" in there and "press" in there:
        inputs = portrait_pressed.PressedThumbnailInputs(mesh=there["mesh"], contact=there["press"])
        calls.append(portrait_pressed.STAGE.call(inputs))
    return tuple(calls)


def thumbnail_png(store: Store, keys: Mapping[str, str]) -> bytes | None:
    """What is drawn and stored of a variant, as one PNG file; None where nothing is.

    Raises:
        StoreError: If a result is damaged.
    """
    tiles: dict[str, np.ndarray] = {
        call.stage: _drawn(store.load(call.stage, call.key).png)
        for call in thumbnail_calls(store, keys)
        if store.has(call.stage, call.key)
    }
    if "shoot" in keys and store.has("shoot", keys["shoot"]):
        shown = np.asarray(store.load("shoot", keys["shoot"]).frames.rgb[-1])
        tiles["shoot"] = _fitted(shown)
    if not tiles:
        return None
    # All of one width, so that a list of them is even: what has not been made stays blank.
    blank = np.full((TILE_PX, TILE_PX, 3), GROUND, dtype=np.uint8)
    return png_bytes(np.concatenate([tiles.get(stage, blank) for stage in TILES], axis=1))


def first_tile(png: bytes) -> bytes:
    """What stands first in a thumbnail, as one PNG file: for lists of membranes at rest."""
    import cv2

    bgr = cv2.imdecode(np.frombuffer(png, dtype=np.uint8), cv2.IMREAD_COLOR)
    if bgr is None:
        # Not to be read: a page shows that it is broken.
        return png
    return png_bytes(np.asarray(bgr)[:, :TILE_PX, ::-1])


def _drawn(png: np.ndarray) -> np.ndarray:
    """A PNG with a clear ground as a tile, shape (T, T, 3), uint8."""
    import cv2

    bgra = np.asarray(cv2.imdecode(np.array(png), cv2.IMREAD_UNCHANGED))
    share = bgra[..., 3:].astype(np.float32) / 255.0
    rgb = share * bgra[..., 2::-1] + (1.0 - share) * np.array(GROUND)
    return _fitted(np.rint(rgb).astype(np.uint8))


def _fitted(rgb: np.ndarray) -> np.ndarray:
    """An image within a tile, its proportions kept, shape (T, T, 3), uint8."""
    return framed(rgb, (TILE_PX, TILE_PX))


def framed(rgb: np.ndarray, size_px: tuple[int, int], ground: Sequence[int] = GROUND) -> np.ndarray:
    """An image as large as fits a frame of width and height [px], its proportions kept."""
    import cv2

    width, height = size_px
    share = min(width / rgb.shape[1], height / rgb.shape[0])
    size = (max(1, round(share * rgb.shape[1])), max(1, round(share * rgb.shape[0])))
    way = cv2.INTER_AREA if share < 1.0 else cv2.INTER_LINEAR
    scaled = cv2.resize(np.ascontiguousarray(rgb), size, interpolation=way)
    frame = np.full((height, width, 3), ground, dtype=np.uint8)
    top, left = (height - size[1]) // 2, (width - size[0]) // 2
    frame[top : top + size[1], left : left + size[0]] = scaled
    return frame
