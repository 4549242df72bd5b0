"""A press solved by finite elements: the ground truth that faster ways are judged by.

Every frame is divided into increments in which no point of the object moves farther than
`increment_mm`. An increment that does not converge is divided; if that fails too the press ends
with an error and the frames before it: what has not converged is never passed on.
Left out: soft objects, self-contact.
"""

from __future__ import annotations

import contextlib
import dataclasses
from collections.abc import Callable
from dataclasses import fields
from typing import Any

import numpy as np

from sim.contact.motion.approach import Approach
from sim.contact.motion.rests import pieces_of
from sim.contact.objects.sampling import SAMPLES_PER_CELL
from sim.contact.readout.verdict import check_depth
from sim.contact.region.backing import support_points_mm
from sim.contact.region.placing import place_object
from sim.fem.contact_law import PENALTY, Law
from sim.fem.extent import part_of
from sim.fem.increment import Pairing, advance, at_rest
from sim.fem.newton import Effort
from sim.fem.obstacle import RigidPose
from sim.fem.readout import FemFrame, read_frame
from sim.fem.submodel import Submodel, cut_out
from sim.fem.tangent import Tangent
from workbench.core.base.errors import DesignError, SolveError
from workbench.core.base.freed_memory import freed_memory_kept
from workbench.core.base.monitor import Monitor, silent
from workbench.core.design.design import Elastomer
from workbench.core.press.fem import FemSettings
from workbench.core.press.press_case import PressCase
from workbench.core.result.force_field import ForceField, Source
from workbench.core.result.results import MembraneMesh
from workbench.core.result.sampled import SampledDistance

COARSER_SHARE = 0.3
"""Share of the work that the coarser mesh of an estimate takes."""

OnFrame = Callable[[int, FemFrame], None]


def sampling_grid_mm(settings: FemSettings) -> float:
    """Edge of the contact grid whose sampled distances are as fine as the settings ask for [mm]."""
    return SAMPLES_PER_CELL * settings.sampling_mm


def solve_press(
    mesh: MembraneMesh,
    material: Elastomer,
    case: PressCase,
    *,
    sampled: SampledDistance | None = None,
    device: str = "cpu",
    monitor: Monitor = silent,
    on_frame: OnFrame = lambda frame, outcome: None,
) -> ForceField:
    """Solve a press frame by frame.

    Args:
        mesh: The membrane, meshed at `case.fem.hex_mm`.
        material: The elastomer, with its friction against the object.
        case: The rigid object, its path, the regions that are driven meanwhile; region,
            increments, tolerance.
        sampled: The object's distance on `sampling_grid_mm` where a store has it.
        device: `cpu`, or `cuda` where linear equations are to be solved on a GPU by PyTorch.
        monitor: Told frame and progress; raises `Cancelled` to stop.
        on_frame: Given each frame as soon as it has converged.

    Raises:
        DesignError: If the target is off the skin, the object cannot be made, is soft or would
            reach the support, or a driven region does not exist.
        MeshingError: If the membrane has no hexahedra.
        SolveError: If an increment does not converge; carries the frames before it.
    """
    monitor(0.0, "placing the object")
    approach, submodel = set_up(mesh, material, case, sampled=sampled)
    course = _Course(mesh, material, approach, case.fem, submodel, device)
    estimate = case.fem.error and submodel.finest > 0
    share = 1.0 - COARSER_SHARE if estimate else 1.0
    try:
        course.run(_share(monitor, 0.0, share, ""), on_frame)
    except SolveError as error:
        error.frame, error.last_good = course.frame, course.frame - 1
        error.message = f"frame {course.frame + 1} of {approach.frame_count}: {error.message}"
        error.partial = course.result() if course.outcomes else None
        raise
    found = course.result()
    if not estimate:
        return found
    coarser = cut_out(mesh, material, case.press, submodel.part.coarser())
    second = _Course(mesh, material, approach, case.fem, coarser, device)
    # Frames that the coarser mesh does not reach have no estimate.
    with contextlib.suppress(SolveError):
        second.run(_share(monitor, share, 1.0, "error, "), lambda frame, outcome: None)
    return dataclasses.replace(found, force_error=_force_error(course.outcomes, second.outcomes))


def _share(monitor: Monitor, begin: float, end: float, prefix: str) -> Monitor:
    """A monitor of a part of the work, from one share of it to another."""

    def told(fraction: float, note: str = "") -> None:
        monitor(begin + (end - begin) * fraction, f"{prefix}{note}")

    return told


def _force_error(fine: list[FemFrame], coarse: list[FemFrame]) -> np.ndarray:
    """Relative error of the finer mesh's reaction, frame by frame, shape (K,).

    Richardson's extrapolation: all edges are half as long, and of an error that falls with their
    square a third of the difference is left.
    """
    found = np.full(len(fine), np.nan)
    for frame, (one, other) in enumerate(zip(fine, coarse, strict=False)):
        size_N = float(np.linalg.norm(one.reaction_N))
        if size_N > 0.0:
            found[frame] = (float(np.linalg.norm(other.reaction_N)) - size_N) / size_N / 3.0
    return found


def set_up(
    mesh: MembraneMesh,
    material: Elastomer,
    case: PressCase,
    *,
    sampled: SampledDistance | None = None,
) -> tuple[Approach, Submodel]:
    """The object, its path and the part of the membrane of a press, before anything is solved.

    Args:
        mesh: The membrane.
        material: The elastomer.
        case: Object, path and settings.
        sampled: The object's distance where a store has it.

    Raises:
        DesignError: As `solve_press`.
        MeshingError: As `solve_press`.
    """
    indenter, press, settings = case.indenter, case.press, case.fem
    if indenter.soft is not None:
        raise DesignError(
            "finite elements take rigid objects only, and this one is soft",
            hint="make the object rigid, or use the forces of the contact solver (source mpm)",
            at="indenter.soft",
        )
    approach = place_object(
        mesh.outer, indenter, press, grid_mm=sampling_grid_mm(settings), sampled=sampled
    )
    check_depth(support_points_mm(mesh), approach)
    return approach, cut_out(mesh, material, press, part_of(mesh, material, approach, settings))


class _Course:
    """A press under way."""

    def __init__(
        self,
        mesh: MembraneMesh,
        material: Elastomer,
        approach: Approach,
        settings: FemSettings,
        submodel: Submodel,
        device: str,
    ) -> None:
        self.mesh = mesh
        self.approach = approach
        self.settings = settings
        self.submodel = submodel
        self.pairing = Pairing(
            tangent=Tangent(submodel.body, device=device),
            law=Law(
                penalty_MPa_mm=PENALTY * material.young_MPa,
                friction=material.friction,
                kinetic_friction=material.kinetic_friction,
            ),
            collider=approach.collider,
            pose_at=self._pose,
            held_mm=self._held_mm,
            tolerance=settings.tolerance,
        )
        self.frame = 0
        self.outcomes: list[FemFrame] = []

    def run(self, monitor: Monitor, on_frame: OnFrame) -> None:
        """Solve all frames; the memory of the factors is given back, also after an error."""
        try:
            with freed_memory_kept():
                self._frames(monitor, on_frame)
        finally:
            self.pairing.tangent.close()

    def _frames(self, monitor: Monitor, on_frame: OnFrame) -> None:
        count, state = self.approach.frame_count, at_rest(self.pairing)
        for frame in range(count):
            self.frame = frame
            effort = Effort()
            label = f"frame {frame + 1} of {count}"

            def watch(progress: float, label: str = label) -> None:
                monitor(progress / count, label)

            effort.watch = lambda now=state.progress, watch=watch: watch(now)
            before = state
            for goal in self._goals(frame):
                state = advance(self.pairing, state, goal, effort, watch=watch)
            outcome = read_frame(self.mesh, self.submodel, self.pairing, state, before, effort)
            self.outcomes.append(outcome)
            on_frame(frame, outcome)
        monitor(1.0, "converged")

    def result(self) -> ForceField:
        """All converged frames."""
        stacked: dict[str, Any] = {
            field.name: np.stack([np.asarray(getattr(o, field.name)) for o in self.outcomes])
            for field in fields(FemFrame)
        }
        body = self.submodel.body
        return ForceField(
            source=Source.FEM,
            **stacked,
            target_mm=self.approach.target_mm,
            normal=self.approach.normal,
            tangent_u=self.approach.tangent_u,
            radius_mm=self.submodel.part.radius_mm,
            spacing_mm=self.settings.hex_mm,
            solver=f"{len(body.elements.cells)} hexahedra, halved up to "
            f"{self.submodel.finest} times, {len(body.system.free)} equations, "
            f"{self.pairing.tangent.solver_name}",
        )

    def _pose(self, progress: float) -> RigidPose:
        origin_mm, rotation = self.approach.pose(progress)
        return RigidPose(origin_mm=origin_mm, rotation=rotation)

    def _held_mm(self, progress: float) -> np.ndarray:
        body, drive = self.submodel.body, self.submodel.marks.drive
        found = np.zeros_like(body.points_mm)
        for number, actuation in enumerate(self.approach.press.actuations):
            members = drive == number
            found[members] = actuation.displacement_mm(body.points_mm[members], progress)
        return found

    def _goals(self, frame: int) -> list[float]:
        """Progress at the end of each increment of a frame."""
        way_mm = self.approach.travel_mm(frame, self.approach.collider.reach_mm)
        way_mm = max(way_mm, self._driven_mm(frame))
        pieces = pieces_of(way_mm, self.settings.increment_mm)
        return [frame + (piece + 1.0) / pieces for piece in range(pieces)]

    def _driven_mm(self, frame: int) -> float:
        """Farthest way of a driven node in a frame [mm]."""
        if not self.approach.press.actuations:
            return 0.0
        way_mm = self._held_mm(frame + 1.0) - self._held_mm(float(frame))
        return float(np.linalg.norm(way_mm, axis=1).max(initial=0.0))
