"""Quasi-static presses, frame by frame, one or many at once.

Each frame moves the object along its path in a short ramp and then relaxes until the forces
balance; where it rubs, it does so at the end of each increment (`motion.rests`), about which less
is asked. Where nothing rubs and the path goes straight on, the displacement is first extrapolated
along it. A frame has settled when the out-of-balance force is below `tolerance` of the load, its
sum below half a percent, and the reaction has stopped changing (`calm`).
Many presses are relaxed in one launch; each fails by itself.
Left out: self-contact, inertia, viscosity; speed enters nowhere.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sim.contact.engine.balances import Balance, Balances
from sim.contact.engine.launcher import STEPS
from sim.contact.engine.relaxation import Relaxation
from sim.contact.readout.frame import FrameOutcome
from sim.contact.readout.outcome import SettledFrame, collect, frame_outcome
from sim.contact.readout.problem import Problem
from sim.contact.readout.slipping import with_slip
from sim.contact.readout.verdict import check_frame
from sim.contact.solver import calm
from sim.contact.solver.load import Load
from sim.contact.solver.progress import Progress
from sim.contact.solver.run import Run, relaxation_of
from workbench.core.base.errors import SolveError, Stopped
from workbench.core.base.monitor import Monitor, silent
from workbench.core.result.sensing import Contact

PATIENCE = 300
"""Substeps without a lower residual before the fictitious masses are doubled."""
MOST_RETRIES = 4


def solve(problems: Sequence[Problem], *, monitor: Monitor = silent) -> list[Contact | SolveError]:
    """Solve presses side by side; the result of each is what it would be alone, bit by bit."""
    solver = Solver(problems, monitor)
    solver.run()
    return solver.results()


def resume(
    problem: Problem, relaxation: Relaxation, *, frame: int = 0, monitor: Monitor = silent
) -> Contact:
    """Solve the frames of one press from `frame` on, from where its arrays stand.

    Args:
        problem: The press; `relaxation` has the arrays of its region.
        relaxation: Displacement and contact history at the end of the frame before.
        frame: First frame that is solved.
        monitor: As for `press_membrane`.

    Raises:
        SolveError: If a frame does not settle or is not sound.
    """
    solver = Solver([problem], monitor, relaxation=relaxation, frame=frame)
    solver.run()
    (result,) = solver.results()
    if isinstance(result, SolveError):
        raise result
    return result


class Solver:
    """Presses under way; arrays have an entry for each."""

    def __init__(
        self,
        problems: Sequence[Problem],
        monitor: Monitor,
        *,
        relaxation: Relaxation | None = None,
        frame: int = 0,
    ) -> None:
        self.monitor = monitor
        self.relaxation = relaxation or relaxation_of(problems)
        self.runs = [
            self.make_run(problem, number, frame) for number, problem in enumerate(problems)
        ]
        count = len(problems)
        self.load = Load(problems)
        self.most = np.array([p.settings.max_substeps for p in problems])
        self.passing_most = np.array([run.passing_substeps for run in self.runs])
        self.driven = [run.number for run in self.runs if run.problem.press.actuations]
        self.on_the_way = np.zeros(count, bool)
        self.settling = np.zeros(count, bool)
        self.active = np.ones(count, bool)
        self.substeps = np.zeros(count, int)
        self.spent = np.zeros(count, int)
        self.lowest = np.full(count, np.inf)
        self.lowest_at = np.zeros(count, int)
        self.changes = calm.Changes(count)
        self.retries = np.zeros(count, int)
        self.residual = np.full(count, np.inf)
        self.progress = Progress(self.runs)
        for case in range(count):
            self._begin(case)

    def make_run(self, problem: Problem, number: int, frame: int) -> Run:
        """The way of one press through its frames."""
        return Run(problem, self.relaxation, number, frame=frame)

    def run(self) -> None:
        """Relax until every press has ended.

        Raises:
            Stopped: If Ctrl-C came after frames of a single press had settled; it holds them.
        """
        try:
            self._relax()
        except KeyboardInterrupt as asked:
            first = self.runs[0]
            if len(self.runs) > 1 or not first.outcomes:
                raise
            partial = collect(first.outcomes, first.problem, substeps=int(self.substeps[0]))
            raise Stopped("cancelled", partial=partial) from asked

    def _relax(self) -> None:
        while self.active.any():
            ramping = np.flatnonzero(self.active & ~self.settling)
            if len(ramping):
                rows = np.stack([self.runs[case].feed() for case in ramping.tolist()])
                self.relaxation.set_all_poses(ramping, rows)
            self.relaxation.advance(self.active)
            self.substeps[self.active] += STEPS
            if self.settling.any():
                self._look()
            arrived = [case for case in ramping.tolist() if self.runs[case].arrived]
            if arrived:
                rows = np.stack([self.runs[case].last_pose() for case in arrived])
                self.relaxation.set_all_poses(np.array(arrived), rows)
                self.settling[arrived] = True
            told = self.progress.report(self.active, self.settling, self.spent, self.residual)
            self.monitor(*told)
        self.monitor(1.0, "settled")

    def results(self) -> list[Contact | SolveError]:
        """What each press came to."""
        return [
            run.error or collect(run.outcomes, run.problem, substeps=int(self.substeps[run.number]))
            for run in self.runs
        ]

    def _begin(self, case: int) -> None:
        """Start the next frame of a press, or an attempt at the same one."""
        self.runs[case].begin()
        self.progress.begin(case)
        self.settling[case] = self.runs[case].arrived
        self.on_the_way[case] = self.runs[case].on_the_way
        self.spent[case] = 0
        self.residual[case] = np.inf
        self.lowest[case] = np.inf
        self.lowest_at[case] = 0
        self.changes.begin(case)

    def _look(self) -> None:
        """Judge the settling presses by the forces of the last substep."""
        looked = self.settling.copy()
        self.spent[looked] += STEPS
        balances = self.relaxation.balances(looked, self.residual < self.load.tolerance)
        for case in np.flatnonzero(looked & ~balances.finite).tolist():
            self._unstable(case)
        looked &= balances.finite
        load_N = self._load_N(balances, looked)
        with np.errstate(invalid="ignore", over="ignore"):
            self.residual = np.where(looked, balances.unbalanced_N / load_N, self.residual)
            of_reaction_N = self.load.of_reaction(balances, load_N)
            passed, change = (
                self.changes.within(looks, balances.reaction_N) / of_reaction_N
                for looks in (calm.PASSING_LOOKS, calm.LOOKS)
            )
        self.changes.keep(balances.reaction_N, looked)
        passing = self._passing(passed)
        rests = self.changes.rest(change, self.spent, of_reaction_N)
        still = looked & (rests & self.load.balanced(balances, load_N) | passing)
        if still.any():
            looked &= ~self._close(still, passing)
        lower = looked & (self.residual < self.lowest)
        self.lowest[lower] = self.residual[lower]
        self.lowest_at[lower] = self.spent[lower]
        stalled = looked & (self.spent - self.lowest_at > PATIENCE) & (self.retries < MOST_RETRIES)
        # A residual that will not fall is an oscillation at the limit of stability.
        self.relaxation.burden(stalled)
        self.retries[stalled] += 1
        self.lowest_at[stalled] = self.spent[stalled]
        for case in np.flatnonzero(looked & (self.spent >= self.most)).tolist():
            net = float(np.linalg.norm(balances.net_N[case]) / load_N[case])
            error = self.runs[case].unsettled(float(self.residual[case]), net, float(change[case]))
            self.end(case, error)

    def _passing(self, change: np.ndarray) -> np.ndarray:
        """Which presses are within a frame and have rested there enough, (B,) bool."""
        near = self.residual < calm.PASSING * self.load.tolerance
        near &= change < calm.PASSING * calm.FORCE_CHANGE
        return self.on_the_way & (near | (self.spent >= self.passing_most))

    def _close(self, still: np.ndarray, passing: np.ndarray) -> np.ndarray:
        """End the frame of presses whose forces balance after the last move; which did."""
        final = self.relaxation.evaluate(still)
        load_N = self._load_N(final, still & final.finite)
        settled = still & final.finite & (self.load.balanced(final, load_N) | passing)
        for case in np.flatnonzero(still).tolist():
            if not final.finite[case]:
                self._unstable(case)
            elif settled[case]:
                self.close_frame(case, final.of(case), float(load_N[case]))
        return settled | (still & ~final.finite)

    def close_frame(self, case: int, balance: Balance, load_N: float) -> None:
        """Go on from a settled state: within the frame, or from its end, which is read first."""
        run = self.runs[case]
        if run.on_the_way:
            self._relieve(case)
            run.go_on()
            self._begin(case)
            return
        if not np.isfinite(self.relaxation.snapshot(case)).all():
            self._unstable(case)
            return
        self._relieve(case)
        try:
            self.take_frame(case, self._settled_frame(case, balance, load_N))
        except SolveError as error:
            self.end(case, error)
            return
        self.load.peak_N[case] = max(self.load.peak_N[case], load_N)
        if run.frame < run.problem.approach.frame_count:
            self._begin(case)
        else:
            self.end(case, None)

    def _relieve(self, case: int) -> None:
        """Forgive a press that has settled what it took."""
        self.retries[case] = 0
        self.relaxation.relieve(case)

    def take_frame(self, case: int, frame: SettledFrame) -> None:
        """Read the frame that a press has settled in, and close it.

        Raises:
            SolveError: If it is not sound.
        """
        run, outcome = self.runs[case], self.read_frame(case, frame)
        grid_mm = run.problem.domain.grid_mm
        check_frame(outcome, run.problem.approach, frame.number, grid_mm=grid_mm)
        run.outcomes.append(with_slip(outcome, run.problem, frame.number, run.close()))

    def read_frame(self, case: int, frame: SettledFrame) -> FrameOutcome:
        """What the settled frame of a press says."""
        return frame_outcome(self.runs[case].problem, frame)

    def _settled_frame(self, case: int, balance: Balance, load_N: float) -> SettledFrame:
        """The frame that a press has just settled in."""
        run, relaxation = self.runs[case], self.relaxation
        fixed_N = relaxation.node_forces(case)[run.problem.domain.fixed]
        return SettledFrame(
            number=run.frame,
            balance=balance,
            load_N=load_N,
            seconds=run.seconds,
            nodal_mm=relaxation.displacement(case),
            point_forces_N=relaxation.point_forces(case),
            cut_N=-fixed_N.sum(axis=0, dtype=np.float64),
        )

    def _load_N(self, balances: Balances, looked: np.ndarray) -> np.ndarray:
        """Load of the presses that are looked at, shape (B,)."""
        driving_N = np.zeros(len(self.runs))
        for case in self.driven:
            driving_N[case] = self.runs[case].driving_N() if looked[case] else 0.0
        return self.load.of(balances, driving_N)

    def _unstable(self, case: int) -> None:
        """Try the frame again with heavier nodes and a gentler ramp, or give up."""
        run = self.runs[case]
        if run.attempt >= MOST_RETRIES:
            self.end(case, run.unstable())
            return
        run.attempt += 1
        self.relaxation.burden(np.arange(len(self.runs)) == case)
        self._begin(case)

    def end(self, case: int, error: SolveError | None) -> None:
        """Take a press out of the batch, with its error if it has one."""
        run = self.runs[case]
        if error is not None and run.outcomes:
            error.partial = collect(
                run.outcomes, run.problem, substeps=int(self.substeps[run.number])
            )
        run.error = error
        self.progress.end(case)
        self.active[case] = self.settling[case] = False
