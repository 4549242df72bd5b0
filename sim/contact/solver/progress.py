"""How far presses side by side are: asked for after each round, so of all of them at once."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sim.contact.solver.run import Run

USUAL_SUBSTEPS = 200.0
"""Substeps of rest that count as a whole increment."""


class Progress:
    """Share that is done of each of B presses."""

    def __init__(self, runs: Sequence[Run]) -> None:
        self._runs = runs
        self._before = np.zeros(len(runs))
        """Share before the increment that is under way, shape (B,)."""
        self._own = np.zeros(len(runs))
        """Share that this increment is of the press, shape (B,)."""

    def begin(self, case: int) -> None:
        """A press starts an increment, or once more the same one."""
        run = self._runs[case]
        self._before[case] = run.progress(0.0)
        self._own[case] = run.progress(1.0) - self._before[case]

    def end(self, case: int) -> None:
        """A press ends where it is."""
        self._before[case] = self._runs[case].progress(0.0)
        self._own[case] = 0.0

    def report(
        self, active: np.ndarray, settling: np.ndarray, spent: np.ndarray, residual: np.ndarray
    ) -> tuple[float, str]:
        """Share of all presses that is done, and which frame the slowest is at.

        Args:
            active: Which presses have not ended, (B,) bool.
            settling: Which rest; while the object moves its increment counts as not begun.
            spent: Substeps that each has rested, shape (B,).
            residual: Of each, shape (B,).
        """
        rested = np.where(settling, np.minimum(1.0, spent / USUAL_SUBSTEPS), 0.0)
        done = self._before + rested * self._own
        case = int(np.argmin(np.where(active, done, 2.0)))
        note = self._runs[case].label
        if settling[case] and np.isfinite(residual[case]):
            note += f", residual {residual[case]:.0e}"
        if len(self._runs) > 1:
            note = f"{int(active.sum())} of {len(self._runs)} presses under way; {note}"
        return min(1.0, float(np.mean(done))), note
