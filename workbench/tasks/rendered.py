"""The examples of a task among the renders of a data set."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np

from workbench.core.base.monitor import Monitor
from workbench.learning.dataset.cases import Case
from workbench.learning.dataset.folder import MARKED, PLAIN, DataSet, background_name
from workbench.learning.dataset.photo_export import windows
from workbench.learning.dataset.photo_labels import SLIP, labels_of
from workbench.learning.dataset.sample import Sample, decoded
from workbench.tasks.examples import Seen
from workbench.tasks.seen_images import View, change, motion
from workbench.tasks.task import Look, Task

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
        view: Says which part of an image is seen.
        data: The presses.
        images: Of a sample, and at rest; those of `Renders`, or others of the same presses.
        monitor: Progress.

    Raises:
        StoreError: If a sample is damaged.
    """
    shown, at_rest = images
    listed = list(_windows(task, data))
    for number, (case, frames, more) in enumerate(listed):
        monitor(number / len(listed), case.id)
        samples = [data.sample(case, frame) for frame in frames]
        own = [shown(case, sample) for sample in samples]
        yield Seen(
            name=f"{case.id}:{frames[-1]}",
            place=case.position.name,
            change=change(own, at_rest(case), view),
            motion=motion(own),
            labels={**labels_of(case, samples[-1], data.skin), **more},
        )


def _windows(task: Task, data: DataSet) -> Iterator[tuple[Case, Sequence[int], dict[str, Any]]]:
    """Case, frames, and what is known of each example besides."""
    if task.look is Look.WINDOW:
        for case, row in windows(data):
            frames = range(row["first"], row["first"] + row["frames"])
            yield case, frames, {SLIP: int(row["slip"])}
        return
    for case in data.cases():
        for frame in data.frames(case):
            if frame >= case.first_new:
                yield case, (frame,), {}
