"""A contact seen near: its place of the image, at rest and as it is, side by side and enlarged.

On a finger that is seen from its base by a wide lens, a ball of 6 mm at the tip is a twentieth of
the image wide.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from workbench.core.result.sensing import TactileFrames

WIDER = 1.6
"""Side of what is shown over that of the contact's box [1]."""
LEAST_PX = 24
"""Smallest side of what is shown."""
SIDE_PX = 316
"""Side of each of the two enlarged images."""
BETWEEN_PX = 8
WHITE = 255
LARGE = 0.4
"""Share of the image's height from which a contact is large enough as it is."""


class CloseUp(NamedTuple):
    """A contact enlarged."""

    rgb: np.ndarray
    """At rest and as it is, beside each other, shape (SIDE_PX, 2 SIDE_PX + BETWEEN_PX, 3), uint8"""
    times: float
    """How much it is enlarged [1]."""


class Window(NamedTuple):
    """The place of a contact in the image."""

    rows: slice
    columns: slice


def close_up(frames: TactileFrames, number: int) -> CloseUp | None:
    """The contact of a frame, or of the last one where it has none; None where it is large or none.

    Args:
        frames: Images and fields of a camera.
        number: Frame.
    """
    window = contact_window(frames, number)
    return None if window is None else enlarged(frames, number, window)


def contact_window(frames: TactileFrames, number: int) -> Window | None:
    """Where `close_up` looks; it takes longer to find than to enlarge."""
    from sim.optics.studio.metrics import contact_box, contact_pixels

    for frame in (number, len(frames.rgb) - 1):
        box = contact_box(contact_pixels(frames, frame)) if frame else None
        if box is not None:
            break
    else:
        return None
    high, wide = frames.rgb.shape[1:3]
    side = max(LEAST_PX, *(round(WIDER * (span.stop - span.start)) for span in box))
    if side > LARGE * high:
        return None
    return Window(*(_about(span, side, size) for span, size in zip(box, (high, wide), strict=True)))


def enlarged(frames: TactileFrames, number: int, window: Window) -> CloseUp:
    """A place of the image at rest and in a frame."""
    import cv2

    rows, columns = window
    near = [
        cv2.resize(
            np.asarray(frames.rgb[k])[rows, columns],
            (SIDE_PX, SIDE_PX),
            interpolation=cv2.INTER_CUBIC,
        )
        for k in (0, number)
    ]
    gap = np.full((SIDE_PX, BETWEEN_PX, 3), WHITE, np.uint8)
    times = SIDE_PX / (rows.stop - rows.start)
    return CloseUp(rgb=np.hstack([near[0], gap, near[1]]), times=times)


def _about(span: slice, side: int, size: int) -> slice:
    """A span of a side about the middle of another, moved into the image."""
    first = min(max(0, (span.start + span.stop - side) // 2), size - side)
    return slice(first, first + side)
