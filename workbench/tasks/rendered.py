"""The examples of a task among the renders of a data set."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np

from workbench.core.base.monitor import Monitor
from workbench.learning.dataset.cases import Case
from workbench.learning.dataset.folder import MARKED, PLAIN, DataSet, background_name
from workbench.learning.dataset.photo_export import windows
from workbench.learning.dataset.photo_labels import SLIP, labels_of
from workbench.learning.dataset.sample import Sample, decoded
from workbench.learning.dataset.sequences import FRAMES, gross_slip
from workbench.tasks.examples import Seen
from workbench.tasks.seen_images import View, change, motion
from workbench.tasks.task import Look, Task

MOST_WINDOWS = 2000
"""Of a data set of slides: more do not fit the memory of small machines, and overlap anyway."""
Shown = Callable[[Case, Sample], np.ndarray]
"""The image of a sample, shape (H, W, 3), uint8."""
AtRest = Callable[[Case], np.ndarray]
"""The image at rest that belongs to those of a case."""


class Renders:
    """Images of a data set, as it holds them."""

    def __init__(self, data: DataSet, *, marked: bool) -> None:
        self._data = data
        self._marked = marked
        self._rest: dict[int | None, np.ndarray] = {}

    def shown(self, case: Case, sample: Sample) -> np.ndarray:
        """The image of a sample."""
        return sample.image_markers if self._marked else sample.image

    def at_rest(self, case: Case) -> np.ndarray:
        """The sensor of a case at rest."""
        look = case.drawn.look
        if look not in self._rest:
            part = MARKED if self._marked else PLAIN
            path = self._data.folder / background_name(part, look, ".png")
            self._rest[look] = decoded(path.read_bytes())
        return self._rest[look]


def rendered(
    task: Task, view: View, data: DataSet, images: tuple[Shown, AtRest], monitor: Monitor
) -> Iterator[Seen]:
    """The examples of a task in a data set.

    Args:
        task: Says whether single images or windows are shown.
        view: Says which part of an image is seen. Of windows, which overlap, all are shown where
            it lays contacts flat; else those that the data set lists.
        data: The presses.
        images: Of a sample, and at rest; those of `Renders`, or others of the same presses.
        monitor: Progress.

    Raises:
        StoreError: If a sample is damaged.
    """
    shown, at_rest = images
    found = list(_windows(task, data, listed=view.sight is None))
    for number, (case, frames, more) in enumerate(found):
        monitor(number / len(found), case.id)
        samples = [data.sample(case, frame) for frame in frames]
        own = [shown(case, sample) for sample in samples]
        yield Seen(
            name=f"{case.id}:{frames[-1]}",
            place=case.position.name,
            change=change(own, at_rest(case), view),
            motion=motion(own),
            labels={**labels_of(case, samples[-1], data.skin), **more},
        )


def _windows(
    task: Task, data: DataSet, *, listed: bool
) -> Iterator[tuple[Case, Sequence[int], dict[str, Any]]]:
    """Case, frames, and what is known of each example besides."""
    if task.look is Look.WINDOW:
        yield from _listed(data) if listed else _every(data)
        return
    for case in data.cases():
        for frame in data.frames(case):
            if frame >= case.first_new:
                yield case, (frame,), {}


def _listed(data: DataSet) -> Iterator[tuple[Case, Sequence[int], dict[str, Any]]]:
    """The windows that the data set lists, as many with as without slip, as in the paper."""
    for case, row in windows(data):
        yield case, range(row["first"], row["first"] + row["frames"]), {SLIP: int(row["slip"])}


def _every(data: DataSet) -> Iterator[tuple[Case, Sequence[int], dict[str, Any]]]:
    """All windows of all slides, or one in so many that there are `MOST_WINDOWS` at most."""
    slides = [case for case in data.cases() if len(data.frames(case)) == case.frames]
    count = sum(max(0, case.frames - FRAMES + 1) for case in slides)
    step = max(1, math.ceil(count / MOST_WINDOWS))
    for case in slides:
        onset = gross_slip(data, case)
        for end in range(FRAMES, case.frames + 1, step):
            slips = onset is not None and end - 1 >= onset
            yield case, range(end - FRAMES, end), {SLIP: int(slips)}
