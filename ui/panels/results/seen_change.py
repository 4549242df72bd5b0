"""What is found of a frame's change: its gain, its contact, what is said of it.

Each takes some ten milliseconds of the page's process, more than all else of a frame, and playing
asks for the same frames again and again: they are found once.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from workbench.core.result.sensing import TactileFrames
from workbench.view.close_up import Window, contact_window
from workbench.view.image_views import unseen_words, visible_change


class Found(NamedTuple):
    """What is found of one frame of one camera."""

    gain: int
    """What makes the change visible."""
    unseen: str
    """Why it shows nothing; empty where it shows something."""
    window: Window | None
    """Where the contact is, if it is small."""


class SeenChange:
    """What was found of the images on show."""

    def __init__(self) -> None:
        self._cameras: Sequence[tuple[np.ndarray, TactileFrames | None]] = ()
        self._found: dict[tuple[int, int], Found] = {}

    def take(self, cameras: Sequence[tuple[np.ndarray, TactileFrames | None]]) -> None:
        """Other images: of each camera the background and frames, and their fields."""
        self._cameras = cameras
        self._found.clear()

    def of(self, camera: int, number: int) -> Found:
        """What there is to be found of a frame of a camera."""
        if (camera, number) not in self._found:
            images, frames = self._cameras[camera]
            image, rest = np.asarray(images[number]), np.asarray(images[0])
            self._found[camera, number] = Found(
                gain=visible_change(image, rest)[1],
                unseen=unseen_words(image, rest) if number else "",
                window=None if frames is None else contact_window(frames, number),
            )
        return self._found[camera, number]
