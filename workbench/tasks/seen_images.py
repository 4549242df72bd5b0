"""Images as a network sees them: their size, their difference from rest, the motion in a window.

A network that learns from few presses is shown what is around the contact, with its place told
beside it: else it would have to learn the same at every place. The contact is where the image
differs most from rest.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from workbench.tasks.task import Net

SIDES, LEAST_PX = 6.0, 16.0
"""Side of the square around a contact over the spread of what differs, and its least [px]."""
SMOOTH_PX, OVER_NOISE, NEAR = 1.5, 6.0, 0.25
"""Blur of differences where a contact is looked for [px], what is noise over the median [1], and
how far from its peak it may reach, over the width."""
FEWEST_CORNERS = 4
CORNERS = {"maxCorners": 200, "qualityLevel": 0.05, "minDistance": 4.0}


@dataclass(frozen=True, kw_only=True, slots=True)
class View:
    """What of an image is seen."""

    width_px: int
    """Images that are wider are made smaller [px]."""
    around_px: int
    """Side of the square around the contact, as the network sees it [px]; 0: all of the image."""

    def size_px(self, width_px: int, height_px: int) -> tuple[int, int]:
        """Width and height of the whole at which it is seen; never enlarged."""
        width = min(width_px, self.width_px)
        return width, max(1, round(height_px * width / width_px))


VIEWS = {
    Net.LITE: View(width_px=160, around_px=64),
    Net.OWN: View(width_px=160, around_px=64),
    Net.PAPER: View(width_px=298, around_px=0),
}
"""298 of 4:3 is 224 high, as in the paper's script."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Change:
    """What differs from rest."""

    grey: np.ndarray
    """Differences [grey level], shape (T, h, w, 3), int16."""
    at: tuple[float, ...]
    """Middle of what is shown, across and down, from -1 to 1 over the image; its side over the
    width of the image; root mean square and largest of the difference, logarithms from 0 to 1."""


def change(images: Sequence[np.ndarray], idle: np.ndarray, view: View) -> Change:
    """Images (H, W, 3) uint8 less the one at rest, the same part of each."""
    import cv2

    size_px = view.size_px(idle.shape[1], idle.shape[0])
    rest, *shown = (
        cv2.resize(image, size_px, interpolation=cv2.INTER_AREA) for image in (idle, *images)
    )
    grey = np.stack([image.astype(np.int16) - rest.astype(np.int16) for image in shown])
    if not view.around_px:
        return Change(grey=grey, at=(0.0, 0.0, 1.0, *_strength(grey)))
    column, row, side = _contact(grey)
    scale = view.around_px / side
    shift = 0.5 * (view.around_px - 1)
    affine = np.array([[scale, 0.0, shift - scale * column], [0.0, scale, shift - scale * row]])
    # Beyond the edge nothing differs.
    part = np.stack([cv2.warpAffine(one, affine, (view.around_px, view.around_px)) for one in grey])
    height, width = grey.shape[1:3]
    at = (2.0 * column / width - 1.0, 2.0 * row / height - 1.0, side / width)
    return Change(grey=part, at=(*at, *_strength(part)))


def _strength(grey: np.ndarray) -> tuple[float, float]:
    """How much differs: root mean square and largest, 0 of nothing and 1 of 255 grey levels."""
    sizes = float(np.sqrt((grey.astype(np.float64) ** 2).mean())), float(np.abs(grey).max())
    mean, largest = (math.log1p(size) / math.log(256.0) for size in sizes)
    return mean, largest


def _contact(grey: np.ndarray) -> tuple[float, float, float]:
    """Column and row of the middle of what differs, and the side of a square around it [px].

    Moments of the square of the difference near its peak: the side is `SIDES` times its standard
    deviation. What photographs have of noise everywhere is smoothed, and left out below
    `OVER_NOISE` times what half of the pixels have.
    """
    import cv2

    smooth = [cv2.GaussianBlur(one.astype(np.float32), (0, 0), SMOOTH_PX) for one in grey]
    power = (np.stack(smooth).astype(np.float64) ** 2).sum(axis=(0, 3))
    power = np.maximum(power - OVER_NOISE * np.median(power), 0.0)
    height, width = power.shape
    down, across = np.mgrid[:height, :width]
    peak = np.unravel_index(int(power.argmax()), power.shape)
    power[np.hypot(down - peak[0], across - peak[1]) > NEAR * width] = 0.0
    total = power.sum()
    if not total:
        return 0.5 * (width - 1), 0.5 * (height - 1), float(width)
    by_row, by_column = power.sum(axis=1) / total, power.sum(axis=0) / total
    rows, columns = np.arange(height), np.arange(width)
    row, column = float((by_row * rows).sum()), float((by_column * columns).sum())
    variance = 0.5 * (
        (by_row * (rows - row) ** 2).sum() + (by_column * (columns - column) ** 2).sum()
    )
    return column, row, min(max(SIDES * float(np.sqrt(variance)), LEAST_PX), float(width))


def motion(images: Sequence[np.ndarray]) -> float:
    """Mean motion of corners from the first to the last image over its width; 0 of one image.

    On skin with markers the corners are those of the markers. They are followed by the method of
    Lucas and Kanade over pyramids. Source: Bouguet, Pyramidal implementation of the Lucas Kanade
    feature tracker, 2000; corners: Shi and Tomasi, Good features to track, 1994.
    """
    if len(images) < 2:
        return 0.0
    import cv2

    first, last = (cv2.cvtColor(image, cv2.COLOR_RGB2GRAY) for image in (images[0], images[-1]))
    corners = cv2.goodFeaturesToTrack(first, **CORNERS)
    if corners is None or len(corners) < FEWEST_CORNERS:
        return 0.0
    moved, found, _ = cv2.calcOpticalFlowPyrLK(first, last, corners, corners.copy())
    away_px = np.linalg.norm((moved - corners).reshape(-1, 2), axis=1)[found.ravel() == 1]
    return float(away_px.mean()) / first.shape[1] if len(away_px) else 0.0
