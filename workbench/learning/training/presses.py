"""What training keeps of data sets: the fields of both solvers in each state, sparse, in memory."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from sim.forces.network.spec import Target
from sim.forces.training.fields import Fields, refuse_not_finite, sizes_of
from workbench.core.base.digest import digest
from workbench.core.base.errors import DesignError
from workbench.learning.dataset.cases import Split

INPUT = "mpm.displacement_mm"
TRUTH = {
    Target.FORCE: "fem.contact_force_N",
    Target.DISPLACEMENT: "fem.displacement_mm",
    Target.STRESS: "fem.cauchy_MPa",
}
RAW = {Target.FORCE: "mpm.contact_force_N", Target.DISPLACEMENT: INPUT}
"""What the contact solver alone says of a target; it has no stress at vertices."""


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class SparseField:
    """A field in many states; vertices where it is zero are left out."""

    starts: np.ndarray
    """Where each state's rows begin, and the end of the last, shape (S + 1,), int64."""
    index: np.ndarray
    """Vertex of each row, shape (R,), int32."""
    values: np.ndarray
    """Shape (R, C), float32."""

    @classmethod
    def of(cls, states: Iterable[np.ndarray], channels: int) -> SparseField:
        """Of dense fields (V, C)."""
        starts, index, values = [0], [], []
        for state in states:
            # What is not finite is kept, to be refused by name.
            rows = np.flatnonzero((state != 0.0).any(axis=1))
            starts.append(starts[-1] + len(rows))
            index.append(rows.astype(np.int32))
            values.append(state[rows].astype(np.float32))
        none = np.zeros((0, channels), np.float32)
        return cls(
            starts=np.array(starts, np.int64),
            index=np.concatenate([np.zeros(0, np.int32), *index]),
            values=np.concatenate([none, *values]),
        )

    def dense(self, states: Sequence[int], vertices: int) -> np.ndarray:
        """Some states, shape (S, V, C), float32."""
        found = np.zeros((len(states), vertices, self.values.shape[1]), np.float32)
        for row, state in enumerate(states):
            own = slice(self.starts[state], self.starts[state + 1])
            found[row, self.index[own]] = self.values[own]
        return found


@dataclass(frozen=True, kw_only=True, slots=True)
class State:
    """One sample, without its fields."""

    case: str
    frame: int
    pair: str
    """Object and place, which are never in two splits."""
    split: Split
    indenter: str
    depth_mm: float
    skin: int = 0
    """Number of the skin that is pressed."""

    @property
    def name(self) -> str:
        """For messages."""
        return f"{self.case} frame {self.frame + 1}"


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class RestSkin:
    """A skin that is pressed, at rest."""

    points_mm: np.ndarray
    """Vertices [mm], shape (V, 3), float64."""
    faces: np.ndarray
    """Triangles, shape (F, 3), int32."""
    mesh: str = ""
    """Key of its mesh."""
    design: Mapping[str, Any] = field(default_factory=dict)
    """Of the sensor that it belongs to, as plain tables."""

    @property
    def spacing_mm(self) -> float:
        """Usual distance of two neighbours [mm]."""
        from sim.forces.network.voxels import spacing_mm

        return spacing_mm(self.points_mm, self.faces)


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Presses:
    """States of one skin or several with the fields of both solvers, in their data sets' order."""

    skins: tuple[RestSkin, ...]
    states: tuple[State, ...]
    parts: Mapping[str, SparseField]
    """Fields by the name that they have in a sample."""
    about: Mapping[str, Any]
    """Where they come from, as plain tables: recipe, mesh, versions, what was left out."""

    @property
    def key(self) -> str:
        """Digest of all that a training depends on."""
        listed = [(state.name, state.split, state.skin) for state in self.states]
        arrays = [[p.starts, p.index, p.values] for _, p in sorted(self.parts.items())]
        skins = [[skin.points_mm, skin.faces] for skin in self.skins]
        return digest([listed, sorted(self.parts), arrays, skins])

    def cases(self, split: Split) -> list[str]:
        """Cases of a split in their order, of several skins one in turn: the first are of all."""
        queues = [
            dict.fromkeys(s.case for s in self.states if s.split is split and s.skin == skin)
            for skin in range(len(self.skins))
        ]
        turns = itertools.zip_longest(*queues)
        return [case for turn in turns for case in turn if case is not None]

    def of_split(self, split: Split, *, cases: Sequence[str] | None = None) -> list[int]:
        """Numbers of the states of a split, or of some cases of it."""
        chosen = None if cases is None else set(cases)
        return [
            number
            for number, state in enumerate(self.states)
            if state.split is split and (chosen is None or state.case in chosen)
        ]

    def by_skin(self, states: Sequence[int]) -> dict[int, list[int]]:
        """Numbers of states by the number of their skin, in rising order of skins."""
        found: dict[int, list[int]] = {}
        for number in states:
            found.setdefault(self.states[number].skin, []).append(number)
        return dict(sorted(found.items()))

    def fields(
        self,
        target: Target,
        states: Sequence[int],
        *,
        skin: int = 0,
        takes_force: bool = False,
        corrects: bool = False,
    ) -> Fields:
        """What a network learns from, of some states of one skin.

        Args:
            target: What is predicted.
            states: Their numbers.
            skin: Number of their skin.
            takes_force: Whether the contact solver's force enters too.
            corrects: Whether targets are what is missing in the contact solver's field.

        Raises:
            DesignError: If the target is not among the parts.
            SolveError: If a field is not finite.
            ValueError: If a state is of another skin.
        """
        if any(self.states[number].skin != skin for number in states):
            raise ValueError(f"not all of {len(states)} states are of skin {skin}")
        vertices = len(self.skins[skin].points_mm)
        inputs = self._part(INPUT).dense(states, vertices)
        if takes_force:
            force_N = self._part(RAW[Target.FORCE]).dense(states, vertices)
            inputs = np.concatenate([inputs, force_N], axis=2)
        targets = self._part(TRUTH[target]).dense(states, vertices)
        sizes = sizes_of(targets)
        if corrects:
            targets -= self._part(RAW[target]).dense(states, vertices)
        return Fields(
            inputs=inputs,
            targets=targets,
            sizes=sizes,
            names=tuple(self.states[number].name for number in states),
        )

    def zero_mae(self, target: Target, states: Sequence[int]) -> float:
        """Mean absolute error of always saying zero, in the target's unit; 0 for no state."""
        truth, means = self._part(TRUTH[target]), []
        for number in states:
            own = truth.values[truth.starts[number] : truth.starts[number + 1]]
            size = self._vertices(number) * truth.values.shape[1]
            means.append(float(np.abs(own).sum(dtype=np.float64)) / size)
        return float(np.mean(means)) if means else 0.0

    def raw_errors(self, target: Target, states: Sequence[int]) -> np.ndarray | None:
        """Mean absolute error of the contact solver alone in each state, shape (S,).

        In the target's unit; None where it has no such field.
        """
        if target not in RAW:
            return None
        raw, truth = self._part(RAW[target]), self._part(TRUTH[target])
        errors = []
        for number in states:
            vertices = self._vertices(number)
            one = raw.dense([number], vertices) - truth.dense([number], vertices)
            refuse_not_finite(one, [self.states[number].name], "field")
            errors.append(float(np.abs(one).mean(dtype=np.float64)))
        return np.array(errors)

    def _vertices(self, state: int) -> int:
        return len(self.skins[self.states[state].skin].points_mm)

    def _part(self, name: str) -> SparseField:
        if name not in self.parts:
            raise DesignError(
                f"the data holds no {name}, only {', '.join(sorted(self.parts))}",
                hint="make or pack it again with it, or choose another --target",
                at=name,
            )
        return self.parts[name]
