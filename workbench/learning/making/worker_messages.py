"""What a worker of a data set is told when it opens, and what it says when a case has ended."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from workbench.learning.dataset.recipe import Recipe
from workbench.learning.dataset.sights import Sight
from workbench.learning.making.parcels import Parcel
from workbench.pipeline.stage import Call


@dataclass(frozen=True, kw_only=True, slots=True)
class Setup:
    """What every worker of a data set needs to know; small, as it is sent to each."""

    recipe: Recipe
    key: str
    """Key of the recipe: each sample carries it."""
    folder: Path
    store: Path
    """Root of the store that holds mesh, material points and light."""
    calls: dict[str, Call]
    """Their calls by stage."""
    sights: tuple[Sight, ...]
    """What sees the samples, by the numbers that cases draw."""


@dataclass(kw_only=True, slots=True)
class Report:
    """How a case ended."""

    id: str
    written: int = 0
    """Samples that were not there before."""
    mpm_s: float = 0.0
    """Time of the contact solver [s]; of presses side by side the share of its frames."""
    fem_s: float = 0.0
    """Time of the finite elements [s]."""
    image_s: float = 0.0
    """Time of images [s]."""
    cpu_s: float = 0.0
    """Processor time of the whole case [s]."""
    seconds: float = 0.0
    """Time of the whole case [s]."""
    error: dict[str, Any] = field(default_factory=dict[str, Any])
    """What went wrong; empty when nothing did."""


@dataclass(frozen=True, kw_only=True, slots=True)
class SettledPress:
    """What a presser says of one press."""

    states: Parcel
    """Of its `PressStates`."""
    seconds: float
    """Its share of the time of its batch, by frames [s]."""
    cpu_s: float
    """The same of processor time [s]."""
