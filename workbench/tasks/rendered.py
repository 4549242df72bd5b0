"""The examples of a task among the renders of a data set."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from workbench.core.base.monitor import Monitor
from workbench.learning.dataset.cases import Case
from workbench.learning.dataset.folder import MARKED, PLAIN, DataSet, background_name
from workbench.learning.dataset.photo_export import windows
from workbench.learning.dataset.photo_labels import SLIP, labels_of
from workbench.learning.dataset.sample import Sample, decoded
from workbench.learning.dataset.sequences import FRAMES, gross_slip
from workbench.learning.making.side_by_side import side_by_side
from workbench.tasks.examples import Seen
from workbench.tasks.seen_images import View, change, motion
from workbench.tasks.task import Look, Task

MOST_WINDOWS = 2000
"""Of a data set of slides, about: more do not fit the memory of small machines, and overlap."""


class Images(Protocol):
    """The images of presses: those of `Renders`, or others of the same presses."""

    def shown(self, case: Case, sample: Sample) -> np.ndarray:
        """The image of a sample, shape (H, W, 3), uint8."""
        ...

    def at_rest(self, case: Case) -> np.ndarray:
        """The image at rest that belongs to those of a case."""
        ...


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


@dataclass(frozen=True, kw_only=True, slots=True)
class Shot:
    """Which images of a data set are one example."""

    case: Case
    frames: Sequence[int]
    more: Mapping[str, Any]
    """What is known of it besides its labels."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Looker:
    """Looks at the images of a data set."""

    view: View
    """Says which part of an image is seen. Of windows, which overlap, all are shown where it lays
    contacts flat; else those that the data set lists."""
    data: DataSet
    images: Images

    def __call__(self, shot: Shot) -> Seen:
        """What one example shows.

        Raises:
            StoreError: If a sample is damaged.
        """
        samples = [self.data.sample(shot.case, frame) for frame in shot.frames]
        own = [self.images.shown(shot.case, sample) for sample in samples]
        return Seen(
            name=f"{shot.case.id}:{shot.frames[-1]}",
            place=shot.case.position.name,
            change=change(own, self.images.at_rest(shot.case), self.view),
            motion=motion(own),
            labels={**labels_of(shot.case, samples[-1], self.data.skin), **shot.more},
        )

    def each(self, shots: Sequence[Shot]) -> list[Seen]:
        """What examples show, one after the other."""
        return [self(shot) for shot in shots]

    def shots(self, task: Task) -> list[Shot]:
        """All examples of a task."""
        if task.look is Look.WINDOW:
            found = _listed(self.data) if self.view.sight is None else _every(self.data)
            return list(found)
        return [
            Shot(case=case, frames=(frame,), more={})
            for case in self.data.cases()
            for frame in self.data.frames(case)
            if frame >= case.first_new
        ]


def rendered(task: Task, looker: Looker, monitor: Monitor, jobs: int = 1) -> list[Seen]:
    """The examples of a task in a data set.

    Args:
        task: Says whether single images or windows are shown.
        looker: Looks at them.
        monitor: Progress and cancellation.
        jobs: Processes that look side by side, a case each: to read a dent takes a tenth of a
            second, and windows of a slide share images that are taken anew.

    Raises:
        StoreError: If a sample is damaged.
        LaneError: If a process ended by itself.
    """
    shots = looker.shots(task)
    if jobs > 1:
        cases = itertools.groupby(shots[1:], key=lambda shot: shot.case.id)
        groups = [list(group) for _, group in cases]
        # The first is looked at here, so that the light is in the store before they all ask for it.
        first = looker.each(shots[:1])
        return [*first, *itertools.chain(*side_by_side(looker.each, groups, jobs, monitor))]
    found = []
    for number, shot in enumerate(shots):
        monitor(number / len(shots), shot.case.id)
        found.append(looker(shot))
    return found


def _listed(data: DataSet) -> Iterator[Shot]:
    """The windows that the data set lists, as many with as without slip, as in the paper."""
    for case, row in windows(data):
        frames = range(row["first"], row["first"] + row["frames"])
        yield Shot(case=case, frames=frames, more={SLIP: int(row["slip"])})


def _every(data: DataSet) -> Iterator[Shot]:
    """All windows of all slides, or one in so many that there are about `MOST_WINDOWS`.

    Of those that are left out it takes others from slide to slide.
    """
    slides = [case for case in data.cases() if len(data.frames(case)) == case.frames]
    count = sum(max(0, case.frames - FRAMES + 1) for case in slides)
    step = max(1, math.ceil(count / MOST_WINDOWS))
    for number, case in enumerate(slides):
        onset = gross_slip(data, case)
        for end in range(FRAMES + number % step, case.frames + 1, step):
            slips = onset is not None and end - 1 >= onset
            yield Shot(case=case, frames=range(end - FRAMES, end), more={SLIP: int(slips)})
