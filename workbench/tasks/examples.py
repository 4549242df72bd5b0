"""What networks learn from and are tested on: differences from rest, with what they show.

An image counts as its difference from the same sensor at rest, which takes most of what differs
from sensor to sensor out of it. Values are grey levels from -255 to 255, at the size that the
network sees.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from workbench.core.base.errors import DesignError
from workbench.learning.dataset.photo_labels import POSE, SLIP, Labels
from workbench.tasks.seen_images import Change
from workbench.tasks.task import Look, Task, Told

SLIP_NAMES = ("hold", "slip")


@dataclass(frozen=True, kw_only=True, slots=True)
class Seen:
    """One image, or the images of one window, with labels."""

    name: str
    """Of the file, or of case and frame."""
    place: str
    """On the skin; "" where nobody said."""
    change: Change
    """From rest."""
    motion: float
    """Mean way of what is seen from the first to the last image over its width; 0 of one image."""
    labels: Labels


@dataclass(frozen=True, kw_only=True, slots=True)
class Examples:
    """N examples of one task."""

    names: tuple[str, ...]
    places: np.ndarray
    """Name of each one's place, shape (N,), str."""
    inputs: np.ndarray
    """Differences from rest [grey level], or what the view has in their place, shape
    (N, T, h, w, 3), int16."""
    at: np.ndarray
    """Where and how strong it is, as `Change` has it, shape (N, 8), float32."""
    feet_mm: np.ndarray
    """Middle of each contact on the skin [mm], shape (N, 3)."""
    axes: np.ndarray
    """Axes of each contact, as `Touch` has them, shape (N, 3, 3)."""
    motion: np.ndarray
    """Of windows, over the width of the image, shape (N,)."""
    features: np.ndarray | None = None
    """What a network that does not learn has seen, shape (N, 1 + copies, T, F), of 16 or 32 bit."""
    truth: np.ndarray
    """Number of the class, shape (N,), int64; or values, shape (N, K), float64."""
    outputs: tuple[str, ...]
    """Names of the classes, or of the values."""

    def __len__(self) -> int:
        return len(self.names)

    def only(self, rows: np.ndarray) -> Examples:
        """Those of some numbers."""
        return Examples(
            names=tuple(self.names[k] for k in rows),
            places=self.places[rows],
            inputs=self.inputs[rows],
            at=self.at[rows],
            feet_mm=self.feet_mm[rows],
            axes=self.axes[rows],
            motion=self.motion[rows],
            features=None if self.features is None else self.features[rows],
            truth=self.truth[rows],
            outputs=self.outputs,
        )


def examples(task: Task, seen: Iterable[Seen], outputs: Sequence[str] = ()) -> Examples:
    """The examples of a task.

    Args:
        task: Says which labels count.
        seen: At least one.
        outputs: Classes or values in the order of the network's; none: those that occur.

    Raises:
        DesignError: If there are none, or a class is not among `outputs`.
    """
    found = list(seen)
    if not found:
        raise DesignError(
            "there are no images to learn from",
            hint="see failed.jsonl in the data folder; make more presses",
            at="data",
        )
    names = tuple(outputs) or outputs_of(task, found)
    if task.told is Told.CLASS:
        truth = np.array([_class(each, task, names) for each in found])
    else:
        truth = np.array([[float(each.labels[name]) for name in names] for each in found])
    return Examples(
        names=tuple(each.name for each in found),
        places=np.array([each.place for each in found]),
        inputs=np.stack([each.change.grey for each in found]),
        at=np.array([each.change.at for each in found], np.float32),
        feet_mm=np.array([each.change.foot_mm for each in found]),
        axes=np.array([each.change.axes for each in found]),
        motion=np.array([each.motion for each in found]),
        truth=truth,
        outputs=names,
    )


def outputs_of(task: Task, seen: Sequence[Seen]) -> tuple[str, ...]:
    """Names of the classes or values that occur, sorted where they are classes."""
    if task.look is Look.WINDOW:
        return SLIP_NAMES
    if task.told is Told.CLASS:
        return tuple(sorted({str(each.labels[task.columns[0]]) for each in seen}))
    return columns_of(task, seen[0].labels)


def columns_of(task: Task, labels: Iterable[str]) -> tuple[str, ...]:
    """The numbers of a task among some columns, in their order."""
    own = task.columns
    poses = [name for name in labels if name.startswith(POSE)] if POSE in own else []
    return (*poses, *(name for name in labels if name in own))


def _class(seen: Seen, task: Task, names: Sequence[str]) -> int:
    if task.look is Look.WINDOW:
        return int(float(seen.labels[SLIP]))
    name = str(seen.labels[task.columns[0]])
    if name not in names:
        raise DesignError(
            f"{seen.name} shows {name}, which the renders do not",
            hint=f"rename the class in labels.csv to one of {', '.join(names)}, or leave the "
            "photograph out",
            at="--photos",
        )
    return list(names).index(name)
