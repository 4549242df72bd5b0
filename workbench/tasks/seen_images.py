"""Images as a network sees them: their size, their difference from rest, the motion in a window."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from workbench.tasks.task import Size

WIDTHS_PX = {Size.SMALL: 96, Size.PAPER: 298}
"""Of what a network sees [px]; 298 of 4:3 is 224 high, as in the paper's script."""
FEWEST_CORNERS = 4
CORNERS = {"maxCorners": 200, "qualityLevel": 0.05, "minDistance": 4.0}


def seen_size(width_px: int, height_px: int, size: Size) -> tuple[int, int]:
    """Width and height that a network sees of images of a size [px]; never enlarged."""
    width = min(width_px, WIDTHS_PX[size])
    return width, max(1, round(height_px * width / width_px))


def differences(
    images: Sequence[np.ndarray], idle: np.ndarray, size_px: tuple[int, int]
) -> np.ndarray:
    """Images (H, W, 3) uint8 less the one at rest [grey level], shape (T, h, w, 3), int16."""
    import cv2

    rest, *shown = (
        cv2.resize(image, size_px, interpolation=cv2.INTER_AREA) for image in (idle, *images)
    )
    return np.stack([image.astype(np.int16) - rest.astype(np.int16) for image in shown])


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
