"""One press on its way through the frames: ramps, predictions, drives, and what settled."""

from __future__ import annotations

import math
import time
from collections.abc import Sequence

import numpy as np

from sim.contact.engine.batch import Case
from sim.contact.engine.launcher import STEPS
from sim.contact.engine.relaxation import Relaxation
from sim.contact.grid.layout import POSE
from sim.contact.motion.rests import increments
from sim.contact.readout.frame import FrameOutcome
from sim.contact.readout.problem import Problem
from sim.contact.readout.slipping import Holding, grip_of
from sim.contact.region.drives import driven_displacement_mm
from sim.contact.solver.calm import FORCE_CHANGE, PASSING_SUBSTEPS, PASSING_SUBSTEPS_SOFT
from sim.forces.slip import slides_from_mm
from workbench.core.base.errors import SolveError

RAMP_SUBSTEPS_PER_MM = 100.0
"""Substeps for the object to move 1 mm without a prediction."""
RUBBING_SUBSTEPS_PER_MM = 600.0
"""The same where the object rubs: a skin that is overrun is anchored too far in, and slides back.
A ball 1 mm deep at mu .3 read .6 % less in 1 frame than in 10 at 300, .1 % at 600, and took as
long. Friction of a ball pressed .4 mm straight in at mu .5, what is left of it in 2 and in 8
frames: .076 and .063 N at 300, .049 and .046 at 600, .041 and .043 at 2000, .032 and .031 at
5000."""
LEAVING = 0.5
"""Share of those substeps for an object that leaves: it cannot push the skin too far."""
FREED_DAMPING = 0.1
"""Damping of a skin that is let go: what it learned while it came to rest is of no use then."""
SHORTEST_RAMP = 10
ARM_CELLS = 10.0
"""Distance from its origin at which a turn of the object counts as travel, in cells."""
NET_FORCE = 5e-3
"""Largest sum of the forces on free nodes over the load: what the support would miss."""
MOST_KEPT = 3
"""Settled displacements kept to extrapolate from."""
STILL_MM = 1e-9
"""Travel below which nothing moves."""


def relaxation_of(problems: Sequence[Problem]) -> Relaxation:
    """Device arrays of presses, at rest."""
    return Relaxation(
        [
            Case(
                domain=problem.domain,
                collider=problem.collider,
                friction=problem.material.friction,
                kinetic_friction=problem.material.kinetic_friction,
            )
            for problem in problems
        ]
    )


class Run:
    """State of one press; `number` is its case in the relaxation."""

    def __init__(
        self, problem: Problem, relaxation: Relaxation, number: int, *, frame: int = 0
    ) -> None:
        self.problem = problem
        self.relaxation = relaxation
        self.number = number
        self.frame = frame
        self.increment = 0
        """Which increment of the frame is under way, of `increments`."""
        self.increments = 1
        self.attempt = 0
        self.outcomes: list[FrameOutcome] = []
        self.error: SolveError | None = None
        self._settled = [relaxation.snapshot(number)]
        self._grip = grip_of(problem, relaxation, number)
        self._ramp = np.zeros((0, POSE))
        self._fed = 0
        self._driven_mm = 0.0
        """Farthest way of a driven point in the present frame [mm]."""
        self._way_mm = self._swing_mm = 0.0
        """Farthest way of a point of the object in it [mm]: of its own, and of one an arm away."""
        self._leaving = False
        """Whether the object moves straight outward in it."""
        self._begun_s = time.perf_counter()

    @property
    def arrived(self) -> bool:
        """Whether the object is where the frame wants it."""
        return self._fed >= len(self._ramp)

    @property
    def label(self) -> str:
        """The frame as people count it."""
        return f"frame {self.frame + 1} of {self.problem.approach.frame_count}"

    def progress(self, share: float) -> float:
        """Share of the frames that are done; `share` is that of the present one."""
        within = (self.increment + share) / self.increments
        return min(1.0, (self.frame + within) / self.problem.approach.frame_count)

    @property
    def on_the_way(self) -> bool:
        """Whether the state that settles next lies within the frame, not at its end."""
        return self.increment + 1 < self.increments

    @property
    def passing_substeps(self) -> int:
        """Substeps after which a state within a frame is left."""
        return PASSING_SUBSTEPS_SOFT if self.problem.press.actuations else PASSING_SUBSTEPS

    def go_on(self) -> None:
        """Pass an increment within the frame: what holds on there is history to the next."""
        self._commit()
        self.increment += 1

    def begin(self) -> None:
        """Start the present increment, or its next attempt, from the last settled displacement."""
        if self.attempt == 0 and self.increment == 0:
            self._begun_s = time.perf_counter()
            self._measure()
            self.increments = self._pieces()
            self.drive()
        predicted = self.attempt == 0 and self._predict()
        if self.attempt and self.increment:
            self.relaxation.go_back(self.number)
        elif self.attempt:
            self.relaxation.restart(self.number, self._settled[-1])
        count = 0 if predicted else self._ramp_length()
        steps = (np.arange(count) + 1.0) / max(count, 1)
        if self._rubs and not self._leaving:
            # At rest at both ends: what is still on its way at the end of a ramp rubs too.
            steps = steps**2 * (3.0 - 2.0 * steps)
        self._ramp = self._rows(steps) if count else np.zeros((0, POSE))
        self._fed = 0
        if not count:
            self.stay()
        elif self._leaving:
            self.relaxation.damping[self.number] = FREED_DAMPING

    def feed(self) -> np.ndarray:
        """The next poses of the ramp, shape (STEPS, POSE)."""
        rows = self._ramp[self._fed : self._fed + STEPS]
        self._fed += STEPS
        return rows

    def last_pose(self) -> np.ndarray:
        """Where the object stays once it has arrived, shape (STEPS, POSE)."""
        return np.tile(self._ramp[-1], (STEPS, 1))

    def stay(self) -> None:
        """Leave the object where the frame wants it."""
        self.relaxation.set_poses(self.number, self._rows(np.ones(1)))

    def close(self) -> Holding:
        """Close the settled frame: what held on in it is history to the next."""
        self._keep()
        before, self._grip = self._grip, grip_of(self.problem, self.relaxation, self.number)
        self.frame += 1
        self.increment = 0
        return Holding(before=before, now=self._grip, driven_mm=self._driven_mm)

    def _keep(self) -> None:
        """Make the state that has settled the one to start from."""
        self._settled = [*self._settled, self.relaxation.snapshot(self.number)][-MOST_KEPT:]
        self._commit()

    def _commit(self) -> None:
        """Make what holds on in the state that has settled history."""
        self.relaxation.commit(self.number, slid_mm=self._slid_mm())
        self.attempt = 0

    def _slid_mm(self) -> float:
        """Way in the present increment from which a point slides [mm], of the object's farthest."""
        return float(slides_from_mm(max(self._way_mm, self._driven_mm) / self.increments))

    @property
    def seconds(self) -> float:
        """Time spent on the present frame [s]."""
        return time.perf_counter() - self._begun_s

    def driving_N(self) -> float:
        """Sum of the magnitudes of the driven points' forces [N]; a twist has no resultant."""
        actuations = self.problem.press.actuations
        if not actuations:
            return 0.0
        drive = self.problem.domain.points.drive
        forces = self.relaxation.point_forces(self.number)
        return float(np.linalg.norm(forces[drive >= 0], axis=1).sum())

    def unsettled(self, residual: float, net: float, change: float) -> SolveError:
        """The error of a frame that ran out of substeps: the first measure over its limit."""
        settings = self.problem.settings
        measures = (
            ("a residual", residual, settings.tolerance),
            ("a net force on the free nodes, over the load,", net, NET_FORCE),
            ("a change of the reaction between looks, over the load,", change, FORCE_CHANGE),
        )
        over = (measure for measure in measures if not measure[1] < measure[2])
        what, value, limit = next(over, measures[0])
        remedy = " or contact.tolerance" if what == "a residual" else ""
        return SolveError(
            f"{self.label} has {what} of {value:.1e} after {settings.max_substeps} substeps; the "
            f"limit is {limit:.1e}",
            hint=f"raise contact.max_substeps{remedy}, or press less deep",
            at="contact.max_substeps",
            frame=self.frame,
            residual=residual,
            last_good=self.frame - 1,
        )

    def unstable(self) -> SolveError:
        """The error of a frame whose forces overflowed in every attempt."""
        return SolveError(
            f"{self.label} became unstable {self.attempt + 1} times",
            hint="lower press.depth_mm or raise press.frames",
            frame=self.frame,
            last_good=self.frame - 1,
        )

    def _measure(self) -> None:
        """Measure the way of the object in the present frame."""
        problem, approach, frame = self.problem, self.problem.approach, self.frame
        self._way_mm = approach.travel_mm(frame, problem.collider.reach_mm)
        self._swing_mm = approach.travel_mm(frame, ARM_CELLS * problem.domain.grid_mm)
        (start, end), _ = approach.poses(np.array([frame, frame + 1.0]))
        way = end - start
        self._leaving = bool(way @ approach.normal > np.linalg.norm(way) - STILL_MM)

    def _pieces(self) -> int:
        """In how many increments the present frame is gone.

        Without friction no path matters, and nothing holds on to what has lifted clear.
        """
        approach = self.problem.approach
        clear = self._leaving and approach.depth_mm(self.frame) <= 0.0
        return 1 if clear or not self._rubs else increments(approach, self.frame)

    def _predict(self) -> bool:
        """Extrapolate the displacement of the last frames; False where that would mislead.

        A skin that rubs must be moved, not set: points that the object reaches on the way are
        anchored where they meet it. Extrapolated, four frames at mu 0.5 read 3 % too little force
        and 50 % too much friction. Without friction only the path must go straight on.
        """
        known = min(len(self._settled), self.problem.approach.continues(self.frame))
        if known < 2 or self.problem.press.actuations or self._rubs:
            return False
        *older, before, last = self._settled
        guess = 2.0 * last - before
        if known >= MOST_KEPT:
            guess = 3.0 * last - 3.0 * before + older[-1]
        self.relaxation.restart(self.number, guess)
        return True

    def drive(self) -> None:
        """Tell held points where they go in this frame."""
        press, points = self.problem.press, self.problem.domain.points
        if press.actuations:
            start_mm, end_mm = (
                driven_displacement_mm(points, press, self.frame + share) for share in (0.0, 1.0)
            )
            self.relaxation.drive(self.number, start_mm, end_mm)
            way_mm = np.linalg.norm(end_mm - start_mm, axis=1)
            self._driven_mm = float(way_mm.max(initial=0.0))

    def _ramp_length(self) -> int:
        """Substeps of the ramp, a multiple of `STEPS`; 0 where nothing moves."""
        travel_mm = max(self._swing_mm, self._driven_mm) / self.increments
        if travel_mm < STILL_MM:
            return 0
        per_mm = RUBBING_SUBSTEPS_PER_MM if self._rubs else RAMP_SUBSTEPS_PER_MM
        if self._leaving:
            per_mm = LEAVING * RAMP_SUBSTEPS_PER_MM
        count = max(SHORTEST_RAMP, math.ceil(per_mm * travel_mm)) * 2**self.attempt
        return -(-count // STEPS) * STEPS

    @property
    def _rubs(self) -> bool:
        """Whether the path matters."""
        return self.problem.material.friction > 0.0

    def _rows(self, steps: np.ndarray) -> np.ndarray:
        """Rows of the pose table at shares of the increment, (n,), shape (n, POSE)."""
        shares = (self.increment + steps) / self.increments
        origins, turned = self.problem.approach.poses(self.frame + shares)
        return np.concatenate([origins, turned.reshape(-1, 9), shares[:, None]], axis=1)
