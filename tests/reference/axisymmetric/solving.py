"""Newton's method for a press in increments, with sparse factors.

Every increment starts where the last one points to. Steps are cut where the force out of balance
would do work against them, which ends the changing of points between touching and not, and between
sticking and sliding; an increment that does not settle is taken in halves.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csc_matrix
from scipy.sparse.linalg import splu

from tests.reference.axisymmetric.contact import Kept, Pair, Skin, Touch, touch, untouched
from tests.reference.axisymmetric.grids import Grid
from tests.reference.axisymmetric.solid import Solid, respond

MOST_STEPS = 25
MOST_SHARES = 5
"""Lengths tried of a step."""
SLACK = 0.2
"""Work at the end of a step over that at its start which need not be reduced further."""
TOLERANCE = 1e-8
"""Largest force out of balance over the largest of the contact's nodal forces."""
LEAST_RATIO = 0.05
"""No volume ratio may fall below this."""
MOST_CUTS = 6
"""An increment is halved so many times at most."""
NONE_N = 1e-12
"""Nodal force of a contact that there is not."""


class NotSolvedError(RuntimeError):
    """Newton's method did not converge."""


@dataclass(frozen=True, kw_only=True, slots=True)
class State:
    """In balance at a depth."""

    motion_mm: np.ndarray
    """Displacements, shape (2 N,)."""
    kept: Kept
    rate: np.ndarray
    """Displacements per depth in the last increment, shape (2 N,)."""
    force_N: float = 0.0
    radius_mm: float = 0.0
    steps: int = 0
    """Of Newton's method so far."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Pull:
    """On the free displacements at some place."""

    residual_N: np.ndarray
    """Force out of balance."""
    touch: Touch


class Press:
    """A body and an object: assembles, factors and advances."""

    def __init__(self, grid: Grid, solid: Solid, skin: Skin, pair: Pair) -> None:
        self.solid, self.skin, self.pair = solid, skin, pair
        self.free = np.flatnonzero(~grid.fixed)
        number = np.full(grid.fixed.size, -1)
        number[self.free] = np.arange(self.free.size)
        tables = (solid.unknowns, skin.unknowns)
        keys = np.concatenate([_keys(number[table], self.free.size) for table in tables])
        self._taken = keys >= 0
        pattern, self._slots = np.unique(keys[self._taken], return_inverse=True)
        columns, self._rows = np.divmod(pattern, self.free.size)
        self._starts = np.searchsorted(columns, np.arange(self.free.size + 1))

    def at_rest(self) -> State:
        """The undeformed body."""
        still = np.zeros(2 * (int(self.solid.unknowns.max()) // 2 + 1))
        return State(motion_mm=still, kept=untouched(self.skin), rate=still)

    def advance(self, state: State, depth_mm: float, *, cuts: int = 0) -> State:
        """The state at another depth, in halves where one increment does not converge.

        Raises:
            NotSolvedError: If the smallest increments do not converge either.
        """
        try:
            return self._increment(state, depth_mm)
        except NotSolvedError:
            if cuts == MOST_CUTS:
                raise
            half = self.advance(state, 0.5 * (state.kept.depth_mm + depth_mm), cuts=cuts + 1)
            return self.advance(half, depth_mm, cuts=cuts + 1)

    def _increment(self, state: State, depth_mm: float) -> State:
        way_mm = depth_mm - state.kept.depth_mm
        motion = state.motion_mm + way_mm * state.rate
        pull = self._pull(state.kept, motion, depth_mm)
        if pull is None:
            motion = state.motion_mm
            pull = self._pull(state.kept, motion, depth_mm)
        for step in range(1, MOST_STEPS + 1):
            if pull is None:
                break
            change = np.zeros_like(motion)
            change[self.free] = _solved(self._tangent(motion, pull.touch), pull.residual_N)
            share = self._share(state.kept, depth_mm, motion, change, pull)
            motion = motion + share * change
            pull = self._pull(state.kept, motion, depth_mm)
            if pull is not None and _balanced(pull):
                return State(
                    motion_mm=motion,
                    kept=pull.touch.kept,
                    rate=(motion - state.motion_mm) / way_mm,
                    force_N=pull.touch.pressing_N,
                    radius_mm=pull.touch.radius_mm,
                    steps=state.steps + step,
                )
        raise NotSolvedError(f"no balance at {depth_mm:g} mm")

    def _share(
        self, kept: Kept, depth_mm: float, motion: np.ndarray, change: np.ndarray, pull: Pull
    ) -> float:
        """Share of a step at whose end the residual does little work along it.

        By regula falsi, in which a bound that stays has its work halved (Illinois).
        """
        first = float(pull.residual_N @ change[self.free])
        low, work_low, high, work_high, share = 0.0, first, 1.0, None, 1.0
        for _ in range(MOST_SHARES):
            found = self._pull(kept, motion + share * change, depth_mm)
            if found is None:
                high, work_high, share = share, None, 0.5 * (low + share)
                continue
            work = float(found.residual_N @ change[self.free])
            if abs(work) <= SLACK * abs(first) or (share == 1.0 and work > 0.0):
                return share
            if work > 0.0:
                low, work_low = share, work
                work_high = None if work_high is None else 0.5 * work_high
            else:
                high, work_high = share, work
            share = 0.5
            if work_high is not None:
                share = np.clip(work_low / (work_low - work_high), 0.05, 0.95)
            share = low + share * (high - low)
        return low or share

    def _pull(self, kept: Kept, motion: np.ndarray, depth_mm: float) -> Pull | None:
        """Nothing where a cell turns over."""
        with np.errstate(invalid="ignore"):
            body = respond(self.solid, motion, tangent=False)
        if not body.least_ratio > LEAST_RATIO:
            return None
        touched = touch(self.skin, self.pair, kept, motion, depth_mm)
        unknowns = np.concatenate([self.skin.unknowns.ravel(), self.solid.unknowns.ravel()])
        forces = np.concatenate([touched.force_N.ravel(), -body.force_N.ravel()])
        total = np.bincount(unknowns, forces, motion.size)
        return Pull(residual_N=total[self.free], touch=touched)

    def _tangent(self, motion: np.ndarray, touched: Touch) -> csc_matrix:
        body = respond(self.solid, motion).tangent_N_mm
        assert body is not None
        entries = np.concatenate([body.ravel(), touched.tangent_N_mm.ravel()])[self._taken]
        data = np.bincount(self._slots, entries)
        return csc_matrix((data, self._rows, self._starts), shape=(self.free.size,) * 2)


def _keys(local: np.ndarray, size: int) -> np.ndarray:
    """Places of elements' entries in the matrix, column by column; -1 where one is held."""
    rows, columns = local[:, :, None], local[:, None, :]
    return np.where((rows < 0) | (columns < 0), -1, columns * size + rows).ravel()


def _balanced(pull: Pull) -> bool:
    scale_N = max(np.abs(pull.touch.force_N).max(), NONE_N)
    return bool(np.abs(pull.residual_N).max() <= TOLERANCE * scale_N)


def _solved(matrix: csc_matrix, right: np.ndarray) -> np.ndarray:
    """By factors of a matrix whose pattern, but with friction not its entries, is symmetric."""
    factors = splu(
        matrix,
        permc_spec="MMD_AT_PLUS_A",
        diag_pivot_thresh=0.001,
        options={"SymmetricMode": True},
    )
    return factors.solve(right)
