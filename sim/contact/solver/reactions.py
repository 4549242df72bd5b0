"""Many presses for their reactions only: nothing else is read back from the device.

One frame each. What a stiffness study or an optimiser asks for, at the speed of the device.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sim.contact.engine.balances import Balance
from sim.contact.readout.problem import Problem
from sim.contact.solver.solver import Solver
from workbench.core.base.monitor import Monitor, silent


class Reactions(Solver):
    """Presses of one frame each, side by side; `run` settles them."""

    def __init__(self, problems: Sequence[Problem], monitor: Monitor = silent) -> None:
        super().__init__(problems, monitor)
        self.reaction_N = np.full((len(problems), 3), np.nan)
        """Force on each object [N], shape (B, 3); NaN where a press did not settle."""

    def close_frame(self, case: int, balance: Balance, load_N: float) -> None:
        """Keep the reaction at the end of the frame; go on from a state within it."""
        if self.runs[case].on_the_way:
            super().close_frame(case, balance, load_N)
            return
        self.reaction_N[case] = balance.reaction_N
        self.end(case, None)
