"""One settled frame of a press, again and again while the designer drags: keeps what still fits.

Three ways, chosen by what was kept of the last request:

* deeper at the same place: the next frame of the same press, from its displacement and its contact
  history;
* shallower at the same place: the same region and contact points, from rest;
* anything else: all anew, from rest (1225 substeps for a ball 1 mm deep on the tip at mu 0.3).

Starting from the last displacement at another place is off by 2.6 to 5.3 % in force with the old
contact history, 5.4 to 7.3 % with a fresh one; a region wide enough for several places costs twice
the time of one. So a move along the skin starts from rest.
The object rests as often as in a full press (`motion.rests`), so the force is the same: on the
default finger, 1 mm deep, to .3 %. Gone in one piece it was up to 2.8 % less, in a quarter of the
time.
Left out: strokes, trajectories and driven regions; the full press has them.
"""

from __future__ import annotations

import dataclasses
import enum
from dataclasses import dataclass

import numpy as np

from sim.contact.engine.relaxation import Relaxation
from sim.contact.motion.path import State, legs_of
from sim.contact.press import press_membrane
from sim.contact.readout.problem import Problem, make_problem
from sim.contact.readout.verdict import check_depth
from sim.contact.region.backing import support_points_mm
from sim.contact.solver.run import relaxation_of
from sim.contact.solver.solver import resume
from workbench.core.base.monitor import Monitor, silent
from workbench.core.design.design import Elastomer
from workbench.core.press.motion import press_stroke
from workbench.core.press.press import Method, Press
from workbench.core.press.press_case import PressCase
from workbench.core.result.results import MaterialPoints, MembraneMesh
from workbench.core.result.sensing import Contact

DEEPER_MM = 0.25
"""How much deeper than planned a region and its contact points serve: they reach 1 mm farther."""
SHALLOWER = 0.5
"""Least share of the planned depth for which they serve: a shallow press needs finer points."""


class Way(enum.StrEnum):
    """How a frame was reached."""

    GONE_ON = "gone on"
    SAME_REGION = "same region"
    ANEW = "anew"


def one_frame(press: Press) -> Press:
    """The approach in one frame, with shear and twist in another; what is shown live of a press."""
    return Press(
        target_mm=press.target_mm,
        depth_mm=press.depth_mm,
        shear_mm=press.shear_mm,
        twist_deg=press.twist_deg,
        frames=1,
    )


@dataclass(kw_only=True)
class _Kept:
    """What the last request left behind."""

    key: object
    problem: Problem
    """As it was planned: its depth is that of its region."""
    relaxation: Relaxation
    settled: bool = False
    """Whether the arrays are at rest at `depth_mm`."""
    depth_mm: float = 0.0


class LiveContact:
    """Presses one after the other, with one of them kept; Taichi must have been initialised."""

    def __init__(self) -> None:
        self._kept: _Kept | None = None
        self.way = Way.ANEW
        """How the last frame was reached."""

    def press(
        self,
        mesh: MembraneMesh,
        points: MaterialPoints,
        material: Elastomer,
        case: PressCase,
        *,
        key: object,
        monitor: Monitor = silent,
    ) -> Contact:
        """The last frame of `one_frame(case.press)`, as a contact of one frame.

        Args:
            mesh: Skins, as for a press.
            points: Material points.
            material: The elastomer.
            case: The rigid object, the press without its strokes, trajectory and actuations;
                region, penalty, tolerance.
            key: Equal for requests whose mesh, points, material, indenter and settings are equal.
            monitor: Raises `Cancelled` to stop; the next request then starts from rest.

        Raises:
            DesignError: If the press cannot be placed.
            SolveError: If it does not settle.
        """
        case = dataclasses.replace(case, press=one_frame(case.press))
        path = case.press
        monitor(0.0, "placing the object")
        if case.indenter.soft is not None or case.settings.method is not Method.LATTICE:
            # What deforms the object, or resets its particles, has no state to go on from.
            self.way, self._kept = Way.ANEW, None
            alone = press_membrane(mesh, points, material, case, monitor=monitor)
            return _last_frame(alone)
        kept = self._kept
        if kept is not None and self._serves(kept, key, path):
            if self._deeper(kept, path):
                return self._go_on(kept, path, monitor)
            self.way = Way.SAME_REGION
            approach = dataclasses.replace(kept.problem.approach, press=path)
            problem = dataclasses.replace(kept.problem, approach=approach)
            check_depth(support_points_mm(mesh), approach)
            kept.relaxation = relaxation_of([problem])
        else:
            self.way = Way.ANEW
            problem = make_problem(mesh, points, material, case)
            # Placing takes a third of a second, in which a newer request may have come.
            monitor(0.0, "the region is ready")
            kept = _Kept(key=key, problem=problem, relaxation=relaxation_of([problem]))
            self._kept = kept
        return self._solve(kept, problem, frame=0, depth_mm=path.depth_mm, monitor=monitor)

    @staticmethod
    def _serves(kept: _Kept, key: object, path: Press) -> bool:
        """Whether the region of the kept press is that of this one."""
        planned = kept.problem.press
        same = kept.key == key and dataclasses.replace(path, depth_mm=planned.depth_mm) == planned
        least_mm, most_mm = SHALLOWER * planned.depth_mm, planned.depth_mm + DEEPER_MM
        return same and least_mm <= path.depth_mm <= most_mm

    @staticmethod
    def _deeper(kept: _Kept, path: Press) -> bool:
        """Whether this press goes on from the state of the kept one."""
        return kept.settled and not path.sliding and path.depth_mm >= kept.depth_mm > 0.0

    def _go_on(self, kept: _Kept, path: Press, monitor: Monitor) -> Contact:
        """The kept press as a first frame, and a stroke deeper as the second."""
        self.way = Way.GONE_ON
        deeper = press_stroke(path.depth_mm - kept.depth_mm, frames=1)
        press = dataclasses.replace(path, depth_mm=kept.depth_mm, strokes=(deeper,))
        planned = kept.problem.approach
        legs = legs_of(press, planned.touch_mm, _no_release)
        approach = dataclasses.replace(planned, press=press, legs=legs)
        problem = dataclasses.replace(kept.problem, approach=approach)
        check_depth(support_points_mm(problem.mesh), approach)
        return self._solve(kept, problem, frame=1, depth_mm=path.depth_mm, monitor=monitor)

    @staticmethod
    def _solve(
        kept: _Kept, problem: Problem, *, frame: int, depth_mm: float, monitor: Monitor
    ) -> Contact:
        # A request that is stopped leaves no state of rest behind.
        kept.settled = False
        contact = resume(problem, kept.relaxation, frame=frame, monitor=monitor)
        kept.settled, kept.depth_mm = True, depth_mm
        return _last_frame(contact)


def _no_release(state: State, gap_mm: float) -> float:
    """The depth of a release, which no live press has."""
    return state.depth_mm - gap_mm


def _last_frame(contact: Contact) -> Contact:
    """A contact of the last frame alone."""
    count = len(contact.reaction_N)
    changed = {
        field.name: value[-1:]
        for field in dataclasses.fields(contact)
        for value in (getattr(contact, field.name),)
        if isinstance(value, np.ndarray) and value.ndim and len(value) == count and count > 1
        if field.name not in ("target_mm", "normal", "tangent_u")
    }
    return dataclasses.replace(contact, **changed)
