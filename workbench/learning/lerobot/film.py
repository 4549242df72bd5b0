"""Images as films that a learner can open at any frame, and that show what the camera saw.

H.264 of red, green and blue without loss. A touch changes few pixels by few grey values, less than
a usual film errs: on 160 x 120 renders of a ball in the finger the presses differ from the image at
rest by 47.6 dB (peak signal to noise), and from their own film as LeRobot writes it by default (AV1
4:2:0, crf 30) by 41.8 dB. Without loss a frame took 7.6 KB.
"""

from __future__ import annotations

import contextlib
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

import numpy as np

from workbench.core.base.packages import naming_packages
from workbench.learning.lerobot.layout import FPS, IMAGE, VIDEO_MB, VIDEOS, place

if TYPE_CHECKING:
    import av

CODEC, GIVEN, STORED = "libx264rgb", "rgb24", "gbrp"
"""The encoder, the order of colours that it is given, and that of the planes it writes."""
KEY_FRAMES = 2
"""A frame that needs no other comes at least every so many, as in LeRobot."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Scene:
    """Where an episode is in the films."""

    film: int
    """Number of the file."""
    first: int
    """Its first frame there."""


class Films:
    """The films of a data set: a new one once the last is full, between two episodes."""

    def __init__(self, out: Path, height_px: int, width_px: int) -> None:
        self._out, self._size = out, (height_px, width_px)
        self._open = contextlib.ExitStack()
        self._film: Film | None = None
        self._number = -1

    def add(self, images: list[np.ndarray]) -> Scene:
        """An episode, image by image, each (H, W, 3), uint8."""
        if self._film is None or self._film.size_MB >= VIDEO_MB:
            self._open.close()
            self._number += 1
            path = self._out / place(VIDEOS, self._number, video_key=IMAGE)
            self._film = self._open.enter_context(Film(path, *self._size))
        first = self._film.frames
        for image in images:
            self._film.add(image)
        return Scene(film=self._number, first=first)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *error: object) -> None:
        self._open.close()


class Film:
    """A film that is being written."""

    def __init__(self, path: Path, height_px: int, width_px: int) -> None:
        with naming_packages():
            import av
        path.parent.mkdir(parents=True, exist_ok=True)
        self._file = av.open(str(path), "w")
        options = {"crf": "0", "g": str(KEY_FRAMES)}
        self._stream = self._file.add_stream(CODEC, rate=FPS, options=options)
        self._stream.width, self._stream.height = width_px, height_px
        self._stream.pix_fmt = GIVEN
        self._stream.time_base = Fraction(1, FPS)
        self.frames, self.size_MB = 0, 0.0
        """How many are in it; what was written of them."""

    def add(self, image: np.ndarray) -> None:
        """The next frame, shape (H, W, 3), uint8."""
        import av

        frame = av.VideoFrame.from_ndarray(np.ascontiguousarray(image), format=GIVEN)
        frame.pts = self.frames
        self.frames += 1
        self._write(frame)

    def _write(self, frame: av.VideoFrame | None = None) -> None:
        """Encode a frame, or what the encoder has kept."""
        for packet in self._stream.encode(frame):
            self.size_MB += packet.size / 1e6
            self._file.mux(packet)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *error: object) -> None:
        self._write()
        self._file.close()


def described(height_px: int, width_px: int) -> dict[str, Any]:
    """What `info.json` says of the films."""
    return {
        "video.height": height_px,
        "video.width": width_px,
        "video.codec": "h264",
        "video.pix_fmt": STORED,
        "video.is_depth_map": False,
        "video.fps": FPS,
        "video.channels": 3,
        "has_audio": False,
    }
