"""Pictures of a photograph for the page: what changed from rest, with the contact drawn on it."""

from __future__ import annotations

import numpy as np

from workbench.calibration.seen.photo_set import Circle
from workbench.report.image_files import difference

MOST_PX = 640
"""Width of a picture that goes to the page [px]."""
LEAST_PX = 320
"""Smaller ones are enlarged, so that the circle's line stays thin [px]."""
YELLOW, BLACK = (255, 220, 0), (0, 0, 0)


def contact_picture(image: np.ndarray, circle: Circle | None) -> np.ndarray:
    """An image (H, W, 3) uint8 with the circle of its contact, at a width the page shows."""
    import cv2

    shown, scale = sized(image)
    if circle is None:
        return shown
    middle = tuple(
        round((value + 0.5) * scale - 0.5) for value in (circle.column_px, circle.row_px)
    )
    radius = max(1, round(circle.radius_px * scale))
    for colour, width in ((BLACK, 3), (YELLOW, 1)):
        cv2.circle(shown, middle, radius, colour, width, cv2.LINE_AA)
        cv2.drawMarker(shown, middle, colour, cv2.MARKER_CROSS, 9, width, cv2.LINE_AA)
    return shown


def beside(*images: np.ndarray) -> np.ndarray:
    """Images of one height side by side, with a gap."""
    gap = np.full((images[0].shape[0], 4, 3), 34, np.uint8)
    parts = [part for image in images for part in (gap, image)]
    return np.ascontiguousarray(np.hstack(parts[1:]))


def strip(photo: np.ndarray, predicted: np.ndarray) -> np.ndarray:
    """Photograph, prediction and difference side by side."""
    parts = (photo, predicted, difference(predicted, photo))
    return beside(*(sized(part)[0] for part in parts))


def blended(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Half of each of two images of one size: what does not lie on its like is seen twice."""
    return ((first.astype(np.uint16) + second) // 2).astype(np.uint8)


def as_large(image: np.ndarray, other: np.ndarray) -> np.ndarray:
    """An image at the size of another one."""
    import cv2

    size = other.shape[1], other.shape[0]
    return cv2.resize(np.ascontiguousarray(image), size, interpolation=cv2.INTER_AREA)


def sized(image: np.ndarray) -> tuple[np.ndarray, float]:
    """A copy at a width the page shows, and how much larger it is [1]."""
    import cv2

    width = min(max(image.shape[1], LEAST_PX), MOST_PX)
    scale = width / image.shape[1]
    size = (width, max(1, round(image.shape[0] * scale)))
    kind = cv2.INTER_AREA if scale < 1.0 else cv2.INTER_LINEAR
    return cv2.resize(np.ascontiguousarray(image), size, interpolation=kind), scale
