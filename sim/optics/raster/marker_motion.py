"""How the markers moved in the image: as numbers, and as arrows over an image."""

from __future__ import annotations

import numpy as np

from workbench.core.result.sensing import TactileFrames

ARROW, RIM = (255, 230, 60), (20, 20, 20)
"""Colours of the arrows and of their rim: seen on dark skin and on bright."""
TIP_SHARE = 0.3
"""Length of an arrow's head over the arrow's [1]."""
SHORTEST_PX = 1.0
"""Arrows shorter than this are dots [px]."""
SUBPIXEL_BITS = 4
"""Arrows are drawn to 1/16 of a pixel."""


def marker_motion(frames: TactileFrames) -> np.ndarray:
    """Way of each marker's centre from the background [px], shape (K, M, 2), float32.

    NaN where a marker is hidden now or was in the background. K counts the contact frames.
    """
    return frames.marker_uv_px[1:] - frames.marker_uv_px[:1]


def draw_arrows(
    image: np.ndarray, frames: TactileFrames, number: int, *, scale: float = 1.0
) -> np.ndarray:
    """A copy of an image, shape (H, W, 3), uint8, with an arrow on each marker that is seen.

    Args:
        image: The image to draw over.
        frames: Where the markers are.
        number: Frame, 0 for the background.
        scale: Length of an arrow over the way of its marker [1]; arrows start at rest.
    """
    import cv2

    drawn = np.ascontiguousarray(image).copy()
    start = frames.marker_uv_px[0].astype(np.float64)
    way = scale * (frames.marker_uv_px[number] - start)
    long = np.hypot(way[:, 0], way[:, 1]) >= SHORTEST_PX
    # A pixel's centre has the coordinates of its corner and a half; OpenCV counts from the centre.
    grid = 1 << SUBPIXEL_BITS
    for begin, end in zip((start - 0.5)[long], (start + way - 0.5)[long], strict=True):
        ends = [tuple(int(c) for c in np.rint(point * grid)) for point in (begin, end)]
        for colour, thickness in ((RIM, 3), (ARROW, 1)):
            cv2.arrowedLine(
                drawn,
                ends[0],
                ends[1],
                colour,
                thickness,
                cv2.LINE_AA,
                SUBPIXEL_BITS,
                TIP_SHARE,
            )
    return drawn
