"""Frames of a camera of this computer, of a stream, or of a video of the project."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from workbench.core.base.errors import DesignError

IDLE_FRAMES = 8
"""Frames whose mean is the photograph at rest: its noise is then a third."""
STREAM = "://"


class CameraFrames:
    """An open source."""

    def __init__(self, source: str, project: Path) -> None:
        """Open it.

        Args:
            source: Number of a camera, address of a stream, or name of a video in the project.
            project: The project's folder.

        Raises:
            DesignError: If there is none.
        """
        import cv2

        self.source = source
        self._video: Any = cv2.VideoCapture(_opens(source, project))
        if not self._video.isOpened():
            raise DesignError(
                f"{source} does not open as a camera or a video",
                hint="type 0 for the first camera of this computer, the address of a stream, or "
                "the name of a video in the project's folder",
            )

    def next(self) -> np.ndarray | None:
        """The next frame, shape (H, W, 3), uint8; None where there is none."""
        there, frame = self._video.read()
        return np.ascontiguousarray(frame[:, :, ::-1]) if there else None

    def mean(self) -> np.ndarray:
        """The mean of the next frames, shape (H, W, 3), uint8.

        Raises:
            DesignError: If there is no frame.
        """
        frames = [frame for _ in range(IDLE_FRAMES) if (frame := self.next()) is not None]
        if not frames:
            raise DesignError(
                f"{self.source} gives no frame", hint="check that no other program uses the camera"
            )
        return np.round(np.mean(frames, axis=0)).astype(np.uint8)


def _opens(source: str, project: Path) -> int | str:
    """What OpenCV opens; files only of the project."""
    typed = source.strip()
    if typed.isdecimal():
        return int(typed)
    if STREAM in typed:
        return typed
    path = (project / typed).resolve()
    if not typed or not path.is_relative_to(project.resolve()) or not path.is_file():
        raise DesignError(
            f"there is no video {typed or '(nothing typed)'} in the project",
            hint=f"put it into {project} and type its name, or type the number of a camera",
        )
    return str(path)
