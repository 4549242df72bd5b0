"""What can be looked at of a tactile image: itself, its change, and what its pixels see.

Everything here takes some ten milliseconds of an image of 640 x 480; the fields themselves come
with the image from its stage.
"""

from __future__ import annotations

import enum
from dataclasses import dataclass

import numpy as np

from workbench.core.result.sensing import TactileFrames
from workbench.view.colour_scale import NOTHING_GREY, scale_colours

NO_CHANGE = "no change seen: no camera pixel sees a contact in this frame"
BURNT = "{share:.0f} % of the pixels are white: less LED power, or a shorter exposure, shows more"
BURNT_SHARE = 0.02
"""Of the pixels saturated in every colour, from which it is said."""
ROUNDING_GREY = 1
"""Change of the grey level that rounding alone can make."""
MOST_GAIN = 8
"""A change is strengthened so much at most, where the gain is not chosen."""
LEAST_SCALE_GREY = 8
"""Least end of the scale of a change in false colour: rounding and noise stay dark."""
LINE_GREY = 255
"""Grey level of the line between what was and what is."""
GREY_LEVELS = 256
SATURATING = 0.1
"""Share of the whole change in grey levels that may saturate."""
ARROW_SHARE = 0.08
"""Length of the longest arrow over the width of the image, at most."""


class View(enum.StrEnum):
    """Names for people."""

    IMAGE = "image"
    DIFFERENCE = "difference"
    CHANGE = "change in false colour"
    NORMALS = "normals"
    DEPTH = "depth"
    MARKERS = "markers"
    MOTION = "marker motion"
    CONTACT = "contact mask"


OF_IMAGES = (View.IMAGE, View.DIFFERENCE, View.CHANGE)
"""Views that need nothing but the images: a live press has no more."""


OF_MARKERS = (View.MARKERS, View.MOTION)
CROSS, RIM = (255, 45, 85), (250, 250, 250)
"""Colours of the cross at a chosen pixel, and of its rim."""
CROSS_SHARE = 0.03
"""Half the length of the cross over the width of the image."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Bar:
    """A scale of colours."""

    low: float
    high: float
    unit: str


@dataclass(frozen=True, kw_only=True, slots=True)
class Looked:
    """A view of one frame."""

    rgb: np.ndarray
    """Shape (H, W, 3), uint8."""
    words: str
    """What it shows."""
    bar: Bar | None = None


def views(frames: TactileFrames | None) -> tuple[View, ...]:
    """Views that there are; of images without fields the first two."""
    if frames is None:
        return OF_IMAGES
    marked = frames.marker_uv_px.shape[1] > 0
    return tuple(view for view in View if marked or view not in OF_MARKERS)


def looked(
    view: View,
    images: np.ndarray,
    number: int,
    frames: TactileFrames | None = None,
    *,
    beside: int = 0,
    gain: int | None = None,
) -> Looked:
    """A view of one frame.

    Args:
        view: One of `views`; without `frames` others show the image.
        images: Background and frames, shape (1 + K, H, W, 3), uint8.
        number: Frame, 0 for the background.
        frames: The fields that belong to the images, if known.
        beside: Frame that this one is looked at beside, whose depths and changes have the same
            colours.
        gain: What a difference is multiplied by; None chooses it.
    """
    image = np.asarray(images[number])
    if view is View.DIFFERENCE:
        change, times = visible_change(image, np.asarray(images[0]), gain)
        unseen = unseen_words(image, np.asarray(images[0])) if number else ""
        words = f"change of grey level about mid grey, × {times}"
        return Looked(rgb=change, words="; ".join(part for part in (words, unseen) if part))
    if view is View.CHANGE:
        return _change(*(np.asarray(images[k]) for k in (number, beside, 0)))
    if frames is None or view is View.IMAGE:
        return Looked(rgb=image, words="")
    if view is View.NORMALS:
        return _normals(np.asarray(frames.normal[number]))
    if view is View.DEPTH:
        return _depth(*(np.asarray(frames.depth_z_mm[k]) for k in (number, beside)))
    if view is View.CONTACT:
        return _mask(frames, number)
    if view is View.MARKERS:
        return _markers(image, frames, number)
    return _motion(image, frames, number)


def visible_change(
    image: np.ndarray, background: np.ndarray, gain: int | None = None
) -> tuple[np.ndarray, int]:
    """The change about mid grey, and its factor: the one given, or what makes it visible (<= 8).

    What saturates is a tenth of the change at most, as one sparkle would hide the rest. Counted by
    pixels instead, a faint change all over the image would have a strong contact blown out.
    """
    change = image.astype(np.int16) - background.astype(np.int16)
    if gain is not None:
        return np.clip(128 + gain * change.astype(np.int32), 0, 255).astype(np.uint8), gain
    # Counted by level, the largest first: sorting a million of them takes ten times as long.
    levels = np.arange(GREY_LEVELS)[::-1]
    counts = np.bincount(np.abs(change).ravel(), minlength=GREY_LEVELS)[::-1]
    together = np.cumsum(levels * counts)
    most = int(levels[np.searchsorted(together, SATURATING * together[-1])])
    gain = max(1, min(MOST_GAIN, 127 // most)) if most else 1
    return np.clip(128 + gain * change, 0, 255).astype(np.uint8), gain


def unseen_words(image: np.ndarray, background: np.ndarray) -> str:
    """What is said beside a difference that shows nothing, or of an image that is too bright.

    Returns:
        "" of a difference that shows something in an image that is not saturated.
    """
    share = float((image == np.iinfo(np.uint8).max).all(axis=-1).mean()) if image.size else 0.0
    burnt = BURNT.format(share=100.0 * share) if share >= BURNT_SHARE else ""
    change = np.abs(image.astype(np.int16) - background.astype(np.int16))
    if change.max(initial=0) > ROUNDING_GREY:
        return burnt
    return f"no change seen: {burnt}" if burnt else NO_CHANGE


def wiped(image: np.ndarray, rest: np.ndarray, share: float) -> np.ndarray:
    """What was on the left and what is on the right of a line, shape (H, W, 3), uint8.

    Args:
        image: What is.
        rest: What was; of the same shape.
        share: Where the line stands, over the width: 0 shows what is, 1 what was.
    """
    wide = image.shape[1]
    column = round(min(max(share, 0.0), 1.0) * wide)
    both = np.concatenate([rest[:, :column], image[:, column:]], axis=1)
    if 0 < column < wide:
        both[:, column - 1 : column + 1] = LINE_GREY
    return both


def _change(image: np.ndarray, other: np.ndarray, background: np.ndarray) -> Looked:
    """How far grey levels moved, the channel that moved most; one scale for both frames."""
    moved, beside = (
        np.abs(frame.astype(np.int16) - background.astype(np.int16)).max(axis=-1)
        for frame in (image, other)
    )
    high = float(max(moved.max(initial=0), beside.max(initial=0), LEAST_SCALE_GREY))
    rgb = scale_colours(moved.astype(np.float32), 0.0, high)
    bar = Bar(low=0.0, high=high, unit="grey")
    return Looked(rgb=rgb, words="change of the grey level that moved most", bar=bar)


def _normals(normal: np.ndarray) -> Looked:
    rgb = np.clip(127.5 * (np.nan_to_num(normal.astype(np.float32)) + 1.0), 0.0, 255.0)
    rgb = np.rint(rgb).astype(np.uint8)
    # A pixel that misses the skin has no normal.
    rgb[~(np.abs(normal) > 0.0).any(axis=-1)] = NOTHING_GREY
    words = "normals toward the camera: red, green, blue are x, y, z of the sensor from -1 to 1"
    return Looked(rgb=rgb, words=words)


def _depth(depth_mm: np.ndarray, other_mm: np.ndarray) -> Looked:
    seen = np.isfinite(depth_mm) | np.isfinite(other_mm)
    if not seen.any():
        return Looked(rgb=scale_colours(depth_mm, 0.0, 1.0), words="no pixel sees the skin")
    both = np.fmin(depth_mm, other_mm)[seen], np.fmax(depth_mm, other_mm)[seen]
    # Of the frame and of the one beside it, so that the colours of both compare.
    low, high = float(both[0].min()), float(both[1].max())
    rgb = scale_colours(depth_mm, low, high)
    bar = Bar(low=low, high=high, unit="mm")
    return Looked(rgb=rgb, words="depth along the optical axis", bar=bar)


def _mask(frames: TactileFrames, number: int) -> Looked:
    from sim.optics.studio.metrics import contact_pixels

    moved, contact = np.asarray(frames.moved[number]), contact_pixels(frames, number)
    grey = np.where(contact, 255, np.where(moved, 110, 30)).astype(np.uint8)
    shares = (100.0 * float(pixels.mean()) for pixels in (contact, moved))
    words = "white: contact, {:.1f} % of the pixels; grey: displaced skin, {:.1f} %"
    return Looked(rgb=np.repeat(grey[..., None], 3, axis=-1), words=words.format(*shares))


def crossed(image: np.ndarray, uv_px: np.ndarray) -> np.ndarray:
    """A copy of an image, shape (H, W, 3), uint8, with a cross at (column, row) [px]."""
    drawn = np.array(image)
    high, wide = drawn.shape[:2]
    reach = max(4, int(CROSS_SHARE * wide))
    column, row = (int(c) for c in np.floor(uv_px))
    for colour, width in ((RIM, 2), (CROSS, 1)):
        side = width - 1
        rows = slice(max(row - side, 0), row + side + 1)
        drawn[rows, max(column - reach, 0) : column + reach + 1] = colour
        columns = slice(max(column - side, 0), column + side + 1)
        drawn[max(row - reach, 0) : row + reach + 1, columns] = colour
    if 0 <= row < high and 0 <= column < wide:
        # The pixel itself stays visible.
        drawn[row, column] = image[row, column]
    return drawn


def _markers(image: np.ndarray, frames: TactileFrames, number: int) -> Looked:
    """Rings about the centres of the markers that are seen."""
    import cv2

    drawn = np.ascontiguousarray(image).copy()
    centres = np.asarray(frames.marker_uv_px[number], dtype=np.float64)
    centres = centres[np.isfinite(centres).all(axis=1)]
    radius = max(2, round(image.shape[1] / 100))
    for column, row in np.rint(centres - 0.5).astype(int):
        cv2.circle(drawn, (int(column), int(row)), radius, RIM, 1, cv2.LINE_AA)
    total = frames.marker_uv_px.shape[1]
    return Looked(rgb=drawn, words=f"centres of the markers: {len(centres)} of {total} seen")


def _motion(image: np.ndarray, frames: TactileFrames, number: int) -> Looked:
    from sim.optics.raster.marker_motion import draw_arrows

    way = np.asarray(frames.marker_uv_px[number] - frames.marker_uv_px[0], dtype=np.float64)
    length = np.hypot(way[:, 0], way[:, 1])
    length = length[np.isfinite(length)]
    longest = float(length.max(initial=0.0))
    room = ARROW_SHARE * image.shape[1] / max(longest, 1e-6)
    scale = max(1, min(MOST_GAIN, int(room)))
    words = f"marker motion, arrows × {scale}: longest {longest:.2f} px, {len(length)} markers seen"
    return Looked(rgb=draw_arrows(image, frames, number, scale=float(scale)), words=words)
