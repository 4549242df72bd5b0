"""The frames and episodes of a data set that is being written, and their statistics."""

from __future__ import annotations

from typing import Any

import numpy as np

from workbench.learning.lerobot.film import Scene
from workbench.learning.lerobot.layout import CHUNK_FILES, FPS, IMAGE, INDICES, VALUES
from workbench.learning.lerobot.statistics import (
    Statistics,
    histogram,
    of_histogram,
    of_values,
)


class Book:
    """Grows by an episode at a time; images are not kept."""

    def __init__(self) -> None:
        self.rows: list[dict[str, Any]] = []
        """What is known of each episode, as a row of its table."""
        self.tasks: list[str] = []
        self._parts: list[dict[str, np.ndarray]] = []
        self._pixels = np.zeros((3, 256), dtype=np.int64)

    @property
    def frames(self) -> int:
        """How many there are."""
        return self.rows[-1]["dataset_to_index"] if self.rows else 0

    @property
    def columns(self) -> dict[str, np.ndarray]:
        """Numbers of all frames, (K,) or (K, n), by feature."""
        return {
            name: np.concatenate([part[name] for part in self._parts])
            for name in (*VALUES, *INDICES)
        }

    @property
    def statistics(self) -> dict[str, Statistics]:
        """Of all frames, by feature."""
        return _statistics(self.columns, self._pixels, self.frames)

    def add(
        self,
        task: str,
        columns: dict[str, np.ndarray],
        images: list[np.ndarray],
        scene: Scene,
    ) -> None:
        """An episode.

        Args:
            task: What happens in it.
            columns: Numbers of its frames by feature: `episode.columns_of`.
            images: One for each frame, (H, W, 3), uint8.
            scene: Where they are in the films.
        """
        if task not in self.tasks:
            self.tasks.append(task)
        first, length, number = self.frames, len(images), len(self.rows)
        columns = {
            **columns,
            "episode_index": np.full(length, number),
            "index": first + np.arange(length),
            "task_index": np.full(length, self.tasks.index(task)),
        }
        pixels = sum((histogram(image) for image in images), np.zeros((3, 256), dtype=np.int64))
        self._parts.append(columns)
        self._pixels += pixels
        chunk, file = divmod(scene.film, CHUNK_FILES)
        self.rows.append(
            {
                "episode_index": number,
                "tasks": [task],
                "length": length,
                "data/chunk_index": 0,
                "data/file_index": 0,
                "dataset_from_index": first,
                "dataset_to_index": first + length,
                f"videos/{IMAGE}/chunk_index": chunk,
                f"videos/{IMAGE}/file_index": file,
                f"videos/{IMAGE}/from_timestamp": scene.first / FPS,
                f"videos/{IMAGE}/to_timestamp": (scene.first + length) / FPS,
                **{
                    f"stats/{name}/{what}": value.tolist()
                    for name, found in _statistics(columns, pixels, length).items()
                    for what, value in found.items()
                },
                "meta/episodes/chunk_index": 0,
                "meta/episodes/file_index": 0,
            }
        )


def _statistics(
    columns: dict[str, np.ndarray], pixels: np.ndarray, frames: int
) -> dict[str, Statistics]:
    numbers = {
        name: of_values(values if values.ndim == 2 else values[:, None])
        for name, values in columns.items()
    }
    return {IMAGE: of_histogram(pixels, frames), **numbers}
