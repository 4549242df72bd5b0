"""A data set as LeRobot reads it: an episode is a press path, a frame one of its states.

Episodes lie split by split, and `info.json` says which are which.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from workbench.core.base.errors import DesignError
from workbench.core.base.monitor import Monitor
from workbench.learning.dataset.cases import Case, Split
from workbench.learning.dataset.folder import DataSet
from workbench.learning.dataset.sample import Sample
from workbench.learning.lerobot import layout
from workbench.learning.lerobot.book import Book
from workbench.learning.lerobot.episode import columns_of, task_of
from workbench.learning.lerobot.film import Films, described
from workbench.learning.lerobot.lerobot_card import card_text
from workbench.learning.lerobot.tables import episode_table, frame_table, task_table
from workbench.system.whole_files import write_atomically


@dataclass(frozen=True, kw_only=True, slots=True)
class Written:
    """What was written."""

    episodes: int
    frames: int
    left_out: int
    """Cases that are not whole."""


def export_lerobot(data: DataSet, out: Path, monitor: Monitor, *, marked: bool = False) -> Written:
    """Write a data set in the format of LeRobot v3.0.

    Args:
        data: Made with images.
        out: An empty or new folder.
        monitor: Progress.
        marked: Images with markers instead of those without.

    Raises:
        DesignError: If the folder is not empty, or the data set has no images or no whole case.
        PackageError: If `pyarrow` or `av` is not installed.
        StoreError: If a sample is damaged, or the folder cannot be written.
    """
    if out.exists() and (not out.is_dir() or any(out.iterdir())):
        raise DesignError(f"{out} is not empty", hint="name a new folder", at="--lerobot")
    cases = whole_cases(data)
    height_px, width_px = _image(data.sample(cases[0], 0), marked).shape[:2]
    book = Book()
    with Films(out, height_px, width_px) as films:
        for number, case in enumerate(cases):
            monitor(number / len(cases), case.id)
            samples = [data.sample(case, frame) for frame in range(case.frames)]
            images = [_image(sample, marked) for sample in samples]
            columns = columns_of(samples, data.skin.points_mm)
            book.add(task_of(case), columns, images, films.add(images))
    counts = {
        "total_episodes": len(cases),
        "total_frames": book.frames,
        "total_tasks": len(book.tasks),
    }
    features = layout.features(height_px, width_px, described(height_px, width_px))
    statistics = {
        name: {what: value.tolist() for what, value in found.items()}
        for name, found in book.statistics.items()
    }
    files = {
        layout.place(layout.FRAMES, 0): frame_table(book.columns),
        layout.place(layout.EPISODES, 0): episode_table(book.rows),
        layout.TASKS: task_table(book.tasks),
        layout.STATS: _json(statistics),
        layout.CARD: card_text(data, book.tasks).encode(),
        # Last: a folder without it is no data set.
        layout.INFO: _json(layout.info(counts, splits_of(cases), features)),
    }
    for name, content in files.items():
        write_atomically(out / name, content)
    left_out = len(data.all_cases) - len(cases)
    return Written(episodes=len(cases), frames=book.frames, left_out=left_out)


def whole_cases(data: DataSet) -> list[Case]:
    """Cases of which all frames are done, split by split.

    Raises:
        DesignError: If there is none, or they have no images.
        StoreError: If a sample is damaged.
    """
    found = [
        case
        for split in Split
        for case in data.cases(split)
        if len(data.frames(case)) == case.frames
    ]
    if not found:
        raise DesignError(
            f"none of the {len(data.all_cases)} cases of {data.folder} is whole",
            hint=f"go on with workbench dataset make RECIPE --out {data.folder}",
            at="DATA",
        )
    if not data.sample(found[0], 0).png:
        raise DesignError(
            f"{data.folder} holds no images", hint="make it without --no-images", at="DATA"
        )
    return found


def splits_of(cases: list[Case]) -> dict[str, str]:
    """Episodes of each split as "from:to", where they lie split by split."""
    order = [case.split for case in cases]
    return {
        split.value: f"{order.index(split)}:{order.index(split) + order.count(split)}"
        for split in dict.fromkeys(order)
    }


def _image(sample: Sample, marked: bool) -> np.ndarray:
    return sample.image_markers if marked else sample.image


def _json(table: Mapping[str, Any]) -> bytes:
    return f"{json.dumps(table, indent=4, allow_nan=False)}\n".encode()
