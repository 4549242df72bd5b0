"""Forces of presses side by side at one moment, summed over nodes and points."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, kw_only=True, slots=True)
class Balance:
    """Forces [N] of one case; the fields are those of `Balances`."""

    reaction_N: np.ndarray
    held_N: np.ndarray
    unbalanced_N: float
    net_N: np.ndarray
    inertia_Nmm: float


@dataclass(frozen=True, kw_only=True, slots=True)
class Balances:
    """Forces [N] of B cases at one moment."""

    reaction_N: np.ndarray
    """Force on the object, shape (B, 3)."""
    held_N: np.ndarray
    """Force of the held points on the membrane, shape (B, 3)."""
    unbalanced_N: np.ndarray
    """Euclidean norm of the forces on free nodes, shape (B,)."""
    net_N: np.ndarray
    """Sum of the forces on free nodes, shape (B, 3)."""
    inertia_Nmm: np.ndarray
    """Twice the kinetic energy of the relaxation, m v^2 at a time step of 1, shape (B,)."""

    def of(self, case: int) -> Balance:
        """The forces of one case."""
        return Balance(
            reaction_N=self.reaction_N[case],
            held_N=self.held_N[case],
            unbalanced_N=float(self.unbalanced_N[case]),
            net_N=self.net_N[case],
            inertia_Nmm=float(self.inertia_Nmm[case]),
        )

    @property
    def finite(self) -> np.ndarray:
        """Whether no force has overflowed, shape (B,), bool."""
        found = np.isfinite(self.unbalanced_N)
        for forces in (self.reaction_N, self.held_N, self.net_N):
            found &= np.isfinite(forces).all(axis=1)
        return found
