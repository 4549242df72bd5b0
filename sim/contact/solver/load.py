"""Load of presses side by side: the force against which residuals and changes are measured.

The load is the reaction, plus the forces of driven regions. At nearly zero load 2 % of the peak
stands in for it. Arrays have an entry for each of the B presses.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sim.contact.engine.balances import Balances
from sim.contact.readout.problem import Problem
from sim.contact.solver.run import NET_FORCE

LEAST_LOAD_N = 1e-12
"""Stands in for a load that vanishes altogether."""
LEAST_STRAIN = 0.2
"""Where bodies are carried about, a load of this strain on one cell stands in for a smaller one:
carried by millimetres they have forces of rounding, in single precision, that would never fall
below a share of nothing."""
LEAST_OF_LOAD = 0.05
"""Share of the load that stands in for a smaller reaction."""
LEAST_OF_PEAK = 0.02
"""Share of the peak load that stands in for a vanishing one."""


def least_load_N(young_MPa: float, grid_mm: float) -> float:
    """Force that stands in for the load of a body that is carried about [N]."""
    return LEAST_STRAIN * young_MPa * grid_mm**2


class Load:
    """What the load of each press was at its peak, and what it counts as at the least."""

    def __init__(self, problems: Sequence[Problem]) -> None:
        self.tolerance = np.array([p.settings.tolerance for p in problems])
        self.peak_N = np.zeros(len(problems))
        """Largest load of a settled frame [N], shape (B,)."""
        self.least_N = np.array(
            [
                least_load_N(p.material.young_MPa, p.domain.grid_mm)
                if p.press.actuations
                else LEAST_LOAD_N
                for p in problems
            ]
        )
        """Stands in for a smaller load [N], shape (B,)."""

    def of(self, balances: Balances, driving_N: np.ndarray) -> np.ndarray:
        """Force against which residual and change are measured [N], shape (B,).

        Args:
            driving_N: Sum of the magnitudes of the driven points' forces, shape (B,).
        """
        load_N = np.linalg.norm(balances.reaction_N, axis=1) + driving_N
        return np.maximum(np.maximum(load_N, LEAST_OF_PEAK * self.peak_N), self.least_N)

    def of_reaction(self, balances: Balances, load_N: np.ndarray) -> np.ndarray:
        """Force against which a change of the reaction is measured [N], shape (B,).

        Drives may push far harder than the object: its own reaction must have come to rest too.
        """
        reaction_N = np.linalg.norm(balances.reaction_N, axis=1)
        least_N = np.maximum(LEAST_OF_LOAD * load_N, LEAST_OF_PEAK * self.peak_N)
        return np.maximum(reaction_N, least_N)

    def balanced(self, balances: Balances, load_N: np.ndarray) -> np.ndarray:
        """Whether residual and net force are within their tolerances, shape (B,), bool."""
        net_N = np.linalg.norm(balances.net_N, axis=1)
        small = balances.unbalanced_N < self.tolerance * load_N
        return small & (net_N < NET_FORCE * load_N)
