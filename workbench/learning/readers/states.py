"""States of solved presses: between two frames of a path the skin is taken to move evenly.

Frames are .3 mm apart, and a reader must know all depths between. Displacement and force of the
contact are blended, which is exact for neither, and close for both.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from workbench.learning.dataset.cases import Case
from workbench.learning.dataset.folder import DataSet


@dataclass(frozen=True, kw_only=True, slots=True)
class State:
    """A skin of V vertices, moved."""

    displacement_mm: np.ndarray
    """Shape (V, 3)."""
    force_N: np.ndarray
    """Of the object on the vertices, shape (V, 3); zero where `solved` is not."""
    solved: bool
    """Whether a solver knows the force."""
    name: str
    """The press it comes from."""


class PressStates:
    """The states of some finished cases of a data set."""

    def __init__(self, data: DataSet, cases: Sequence[Case]) -> None:
        self._data = data
        self._cases = [(case, data.frames(case)) for case in cases]

    def __len__(self) -> int:
        """How many cases."""
        return len(self._cases)

    def drawn(self, rng: np.random.Generator) -> State:
        """A state at random: any case, any place on its path from the first frame on."""
        case, frames = self._cases[rng.integers(len(self._cases))]
        place = float(rng.uniform(0.0, len(frames) - 1))
        first = min(int(place), max(len(frames) - 2, 0))
        share = place - first
        ends = [self._data.sample(case, frames[first])]
        if share > 0.0:
            ends.append(self._data.sample(case, frames[first + 1]))
        solved = [end.mpm for end in ends if end.mpm is not None]
        weights = [1.0 - share, share][: len(solved)]
        return State(
            displacement_mm=_blend([each.displacement_mm for each in solved], weights),
            force_N=_blend([each.contact_force_N for each in solved], weights),
            solved=True,
            name=case.id,
        )


def solved_cases(data: DataSet) -> list[Case]:
    """The cases of a data set of which there are states."""
    return [case for case in data.cases() if data.frames(case)]


def untouched(vertices: int) -> State:
    """A skin that nothing touches."""
    still = np.zeros((vertices, 3))
    return State(displacement_mm=still, force_N=still, solved=True, name="untouched")


def _blend(fields: Sequence[np.ndarray], weights: Sequence[float]) -> np.ndarray:
    return sum(
        (weight * field.astype(np.float64) for field, weight in zip(fields, weights, strict=True)),
        np.zeros(fields[0].shape),
    )
