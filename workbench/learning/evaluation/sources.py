"""Where the samples of an evaluation come from: a data set, or a held-out set made from one."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any, Protocol

from workbench.core.base.errors import DesignError
from workbench.learning.dataset.cases import Case, Split
from workbench.learning.dataset.folder import DataSet, SkinData
from workbench.learning.dataset.sample import Sample

HELD_OUT = (Split.TEST, Split.UNSEEN)
"""What no training looks at: seen objects at places that were left out, and unseen objects."""


class Source(Protocol):
    """What `DataSet` and `HeldOut` have in common."""

    manifest: Any
    skin: SkinData

    @property
    def key(self) -> str:
        """Key of the recipe."""
        ...

    def cases(self, split: Split | None = None) -> list[Case]:
        """The cases of one split, or all."""
        ...

    def frames(self, case: Case) -> list[int]:
        """Frames of a case that are there."""
        ...

    def sample(self, case: Case, frame: int) -> Sample:
        """One sample; a StoreError where it is damaged."""
        ...


def open_source(path: Path) -> Source:
    """A data set in a folder, or a held-out set in a file.

    Raises:
        StoreError: If it is neither, or is damaged.
    """
    from workbench.learning.evaluation.held_out import HeldOut

    return HeldOut.open(path) if path.is_file() else DataSet.open(path)


def states(source: Source, splits: Iterable[Split] = HELD_OUT) -> list[tuple[Case, int]]:
    """Every state once: repeats of the approach of the same pair are left out."""
    return [
        (case, frame)
        for split in splits
        for case in source.cases(split)
        for frame in source.frames(case)
        if frame >= case.first_new
    ]


def young_MPa(source: Source) -> float:
    """Young's modulus of the skin that was pressed [MPa]."""
    return float(source.manifest["recipe"]["design"]["material"]["young_MPa"])


def expect_held_out(source: Source, name: str) -> list[tuple[Case, int]]:
    """The states to evaluate with.

    Raises:
        DesignError: If there are none.
    """
    found = states(source)
    if not found:
        raise DesignError(
            f"{name} has no sample of the splits {' and '.join(HELD_OUT)}",
            hint="make more cases of it: one in five of seen objects is kept for tests",
            at=name,
        )
    return found
