"""Many presses whose settled frames are kept as they leave the device, for others to read.

Reading a frame takes a processor as long as a GPU takes to settle several: where many presses are
asked for, the process that has the GPU only settles them.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass

import taichi as ti
from taichi.lang.impl import current_cfg

from sim.contact.readout.outcome import SettledFrame, collect, frame_outcome
from sim.contact.readout.problem import Problem
from sim.contact.readout.slipping import Holding, with_slip
from sim.contact.readout.verdict import check_frame
from sim.contact.solver.solver import Solver
from workbench.core.base.errors import SolveError
from workbench.core.base.monitor import Monitor, silent
from workbench.core.result.sensing import Contact


@dataclass(frozen=True, kw_only=True, slots=True)
class PressStates:
    """All settled frames of a press; plain arrays, which may be sent to another process."""

    frames: list[SettledFrame]
    holdings: list[Holding]
    """What held on in each frame."""
    substeps: int
    device: str
    """`cpu` or `cuda`."""
    error: SolveError | None = None
    """Why the next frame did not settle."""


class States(Solver):
    """Presses side by side; `run` settles them, and nothing of them is read."""

    def __init__(self, problems: Sequence[Problem], monitor: Monitor = silent) -> None:
        self._frames: list[list[SettledFrame]] = [[] for _ in problems]
        self._holdings: list[list[Holding]] = [[] for _ in problems]
        super().__init__(problems, monitor)

    def take_frame(self, case: int, frame: SettledFrame) -> None:
        """Keep the frame that a press has settled in, and close it."""
        self._frames[case].append(frame)
        self._holdings[case].append(self.runs[case].close())

    def states(self) -> list[PressStates]:
        """What each press came to, once `run` has returned."""
        return [
            PressStates(
                frames=frames,
                holdings=holdings,
                substeps=int(self.substeps[run.number]),
                device="cuda" if current_cfg().arch == ti.cuda else "cpu",
                error=run.error,
            )
            for run, frames, holdings in zip(self.runs, self._frames, self._holdings, strict=True)
        ]


def read_states(problem: Problem, states: PressStates) -> Contact:
    """The contact of a press from its settled frames, as `solve` gives it.

    Raises:
        SolveError: If a frame did not settle or is not sound.
    """
    outcomes = []
    for frame, holding in zip(states.frames, states.holdings, strict=True):
        outcome = frame_outcome(problem, frame)
        check_frame(outcome, problem.approach, frame.number, grid_mm=problem.domain.grid_mm)
        outcomes.append(with_slip(outcome, problem, frame.number, holding))
    if states.error is not None:
        raise states.error
    found = collect(outcomes, problem, substeps=states.substeps)
    return dataclasses.replace(found, device=states.device)
