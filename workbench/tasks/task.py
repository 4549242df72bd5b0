"""A task: what is pressed into a design, what a network is shown, what it must tell.

A task is one file of `workbench.tasks.kinds` with a `TASK`. Rows of its results are named by its
metrics; a score of a trivial method stands beside each.
"""

from __future__ import annotations

import enum
from collections.abc import Callable, Mapping
from dataclasses import dataclass

from workbench.core.base.errors import DesignError, shown
from workbench.core.base.mapping import suggest
from workbench.core.base.records import records
from workbench.core.design.design import SensorDesign
from workbench.learning.dataset.recipe import Recipe

PACKAGE = "workbench.tasks.kinds"


class Size(enum.StrEnum):
    """How much is made and learned."""

    SMALL = "small"
    """Minutes on two cores."""
    PAPER = "paper"
    """As many presses as the paper has, for a GPU."""


class Look(enum.StrEnum):
    """What a network is shown."""

    PLAIN = "one image without markers"
    MARKED = "one image with markers"
    WINDOW = "eight images with markers"


class Net(enum.StrEnum):
    """Which network learns."""

    DENT = "dent"
    """Convolutions on the dent that the design's light reads, taught by drawn dents: of objects."""
    MEASURES = "measures"
    """A head over measures of that dent, how deep, wide and steep it is: of its pressure."""
    LITE = "lite"
    """EfficientNet-Lite0 with ImageNet weights, of optional packages, and a head that learns."""
    OWN = "own"
    """Seven convolutions from random weights, where the packages are not there."""
    MOTION = "motion"
    """A committee over numbers of how skin and dent move from image to image: of windows."""
    PAPER = "paper"
    """The paper's ResNet50, and VGG19 with an LSTM; for a GPU."""


class Told(enum.StrEnum):
    """What a network tells."""

    CLASS = "class"
    """One of several names."""
    VALUES = "values"
    """Numbers with units."""


class Null(enum.StrEnum):
    """What tells it without a network."""

    MAJORITY = "the most frequent class of the training part"
    MOTION = "a threshold on the mean motion of what is seen, fitted on the training part"
    MEDIAN = "the median of the training part"
    MEAN = "the mean of the training part"


@dataclass(frozen=True, kw_only=True, slots=True)
class Published:
    """A score that the paper reports, and for which test."""

    metric: str
    sim: float
    """Trained and tested on renders, split at random."""
    real: float
    """Trained on renders, tested on photographs."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Task:
    """One task, for any design."""

    purpose: str
    """What it tells, in a line."""
    recipe: Callable[[SensorDesign, Size], Recipe]
    """What is pressed and seen."""
    look: Look
    told: Told
    columns: tuple[str, ...]
    """Of `labels.csv`: the class, or the numbers; `pose_` stands for all that begin so."""
    metric: str
    """Of its first rows."""
    null: Null
    published: tuple[Published, ...] = ()
    safety: bool = False
    """Whether the coefficient of safety is told in the place of a pressure."""
    formula: str = ""
    """How a label is made, where no column has it."""


def tasks() -> Mapping[str, Task]:
    """All tasks by name."""
    return records(PACKAGE, "TASK")


def task_of(name: str) -> Task:
    """The task of a name.

    Raises:
        DesignError: If there is none.
    """
    known = tasks()
    if name not in known:
        raise DesignError(f"there is no task {shown(name)}", hint=suggest(name, known), at="task")
    return known[name]
