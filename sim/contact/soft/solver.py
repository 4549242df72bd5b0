"""A press of a soft object: two lattices relax together, each with its own damping.

The membrane is case 0 and the object case 1 of a batch that looks like a single press from outside:
its residual is that of both. The object's held part follows the path frame by frame.
"""

from __future__ import annotations

import dataclasses

import numpy as np
import taichi as ti

from sim.contact.engine.balances import Balances
from sim.contact.engine.batch import Case, floats, integers
from sim.contact.engine.bundles import packed
from sim.contact.engine.launcher import Launcher
from sim.contact.engine.relaxation import Relaxation
from sim.contact.grid.layout import MEETS_SOFT
from sim.contact.readout.frame import FrameOutcome
from sim.contact.readout.outcome import SettledFrame, frame_outcome, point_displacement
from sim.contact.readout.problem import Problem
from sim.contact.soft import kernels as soft_kernels
from sim.contact.soft.body import SoftObject, make_soft_object
from sim.contact.soft.meeting import cells_at, deformed, meet
from sim.contact.soft.meeting_functions import MEMBRANE, NOWHERE, OBJECT, Partner
from sim.contact.solver.calm import PASSING_SUBSTEPS_SOFT
from sim.contact.solver.load import least_load_N
from sim.contact.solver.run import Run
from sim.contact.solver.solver import Solver
from sim.forces.slip import LEAST_MM
from workbench.core.base.errors import SolveError
from workbench.core.base.monitor import Monitor
from workbench.core.press.indenter import Indenter
from workbench.core.result.sensing import Contact


def press_soft(problem: Problem, indenter: Indenter, monitor: Monitor) -> Contact | SolveError:
    """Press a soft object; the result also says how the object deforms."""
    solver = SoftSolver(problem, make_soft_object(problem, indenter), monitor)
    solver.run()
    (result,) = solver.results()
    return result


class SoftRelaxation(Relaxation):
    """Membrane and object as if they were one case."""

    def __init__(self, problem: Problem, soft: SoftObject) -> None:
        self.soft = soft
        self.problem = problem
        collider, material = problem.collider, problem.material
        super().__init__(
            [
                Case(
                    domain=soft.membrane,
                    collider=collider,
                    friction=material.friction,
                    kinetic_friction=material.kinetic_friction,
                ),
                Case(domain=soft.domain, collider=collider, friction=0.0),
            ]
        )

    def _launcher(self) -> Launcher:
        batch, soft, membrane = self.batch, self.soft, self.problem.domain
        held = batch.surface.held.to_numpy()
        count = batch.spans[MEMBRANE].points
        held[:count][~membrane.points.bonded] = MEETS_SOFT
        batch.surface.held.from_numpy(held)
        edge = [1.0 / soft.domain.grid_mm]
        origin_mm = soft.origin_mm - membrane.target_mm
        first_cell = -(-len(membrane.rows) // soft_kernels.BLOCK) * soft_kernels.BLOCK
        cells = np.where(soft.cell_map < 0, NOWHERE, soft.cell_map + first_cell)
        partner = Partner(
            lattice=floats(np.concatenate([origin_mm, soft.rotation.ravel(), edge])),
            cell_map=integers(cells),
            extents=integers(np.concatenate([soft.first_cell, soft.cell_map.shape])),
            object_forces=ti.ndarray(ti.i64, batch.nodes.displacement.shape[0]),
        )
        partner.object_forces.fill(0)
        self._partner = packed(partner)
        kernel = soft_kernels.SOFT_SUBSTEP[membrane.linear]
        return Launcher(kernel, (*batch.bundles, partner), cases=2)

    def set_all_poses(self, cases: np.ndarray, rows: np.ndarray) -> None:
        """Poses of the holder in the next substeps."""
        super().set_all_poses(np.array([MEMBRANE, OBJECT]), np.repeat(rows, 2, axis=0))

    def advance(self, moving: np.ndarray) -> None:
        """Substeps of both bodies."""
        super().advance(np.resize(moving, 2))

    def evaluate(self, chosen: np.ndarray) -> Balances:
        """Forces of both bodies where they are."""
        return super().evaluate(np.resize(chosen, 2))

    def balances(self, adapting: np.ndarray, falling: np.ndarray | None = None) -> Balances:
        """Forces of both bodies as those of one."""
        alike = None if falling is None else np.resize(falling, 2)
        both = super().balances(np.resize(adapting, 2), alike)
        return Balances(
            reaction_N=both.reaction_N[:1],
            held_N=both.held_N[:1],
            unbalanced_N=np.hypot(both.unbalanced_N[:1], both.unbalanced_N[1:]),
            net_N=max(both.net_N[:1], both.net_N[1:], key=np.linalg.norm),
            inertia_Nmm=both.inertia_Nmm[:1] + both.inertia_Nmm[1:],
        )

    def burden(self, chosen: np.ndarray) -> None:
        """Double the fictitious masses of both bodies."""
        super().burden(np.resize(chosen, 2))

    def relieve(self, case: int) -> None:
        """Halve the burden of both bodies."""
        for each in (MEMBRANE, OBJECT):
            super().relieve(each)

    def snapshot(self, case: int) -> np.ndarray:
        """Nodal displacements of the membrane, then of the object, shape (N + M, 3)."""
        return np.concatenate([self.displacement(MEMBRANE), self.displacement(OBJECT)])

    def restart(self, case: int, displacement_mm: np.ndarray) -> None:
        """Come to rest at a snapshot."""
        count = self.batch.spans[MEMBRANE].nodes
        super().restart(MEMBRANE, displacement_mm[:count])
        super().restart(OBJECT, displacement_mm[count:])

    def commit(self, case: int, *, slid_mm: float = LEAST_MM) -> None:
        """Make the anchors of a settled frame the history of the next."""
        self._upload()
        soft_kernels.commit_soft_anchors(
            *self.batch.packs, self._partner, self.batch.slips, slid_mm
        )


class SoftRun(Run):
    """A press whose object has a held part to move."""

    @property
    def passing_substeps(self) -> int:
        """Two bodies come to rest more slowly."""
        return PASSING_SUBSTEPS_SOFT

    def drive(self) -> None:
        """Tell driven regions and the object's held part where they go in this frame."""
        super().drive()
        relaxation = self.relaxation
        assert isinstance(relaxation, SoftRelaxation)
        soft = relaxation.soft
        places = soft.domain.points.position_mm
        ways = []
        for share in (0.0, 1.0):
            origin, rotation = self.problem.approach.pose(self.frame + share)
            ways.append(_carried(soft, places, origin, rotation) - places)
        relaxation.drive(OBJECT, *ways)


def _carried(
    soft: SoftObject, places: np.ndarray, origin: np.ndarray, rotation: np.ndarray
) -> np.ndarray:
    """Places of the rigid object at a pose, in its body frame at the start, (N, 3)."""
    return (origin + places @ rotation.T - soft.origin_mm) @ soft.rotation


class SoftSolver(Solver):
    """One press with a soft object."""

    def __init__(self, problem: Problem, soft: SoftObject, monitor: Monitor) -> None:
        self.soft = soft
        self.shapes: list[np.ndarray] = []
        super().__init__([problem], monitor, relaxation=SoftRelaxation(problem, soft))
        self.load.least_N[:] = least_load_N(soft.young_MPa, soft.domain.grid_mm)

    def make_run(self, problem: Problem, number: int, frame: int) -> Run:
        """The way of the press through its frames."""
        return SoftRun(problem, self.relaxation, number, frame=frame)

    def read_frame(self, case: int, frame: SettledFrame) -> FrameOutcome:
        """A settled frame, with normals and overlaps of the deformed object."""
        problem, soft = self.runs[case].problem, self.soft
        pose = problem.approach.pose(frame.number + 1.0)
        nodal = frame.nodal_mm.astype(np.float64)
        points = problem.domain.points
        at = (points.position_mm + point_displacement(problem.domain, nodal))[~points.bonded]
        object_mm = self.relaxation.displacement(OBJECT).astype(np.float64)
        meeting = meet(soft, problem.collider, object_mm, at, pose)
        distance = np.where(meeting.met, meeting.distance_mm, 0.0)
        self.shapes = [*self.shapes[: frame.number], _shape(soft, object_mm, pose)]
        return frame_outcome(problem, frame, met=(distance, meeting.steep @ soft.rotation.T))

    def results(self) -> list[Contact | SolveError]:
        """The contact, with the shape of the object in each frame."""
        (result,) = super().results()
        if isinstance(result, SolveError):
            if result.partial is not None:
                result.partial = self._with_shape(result.partial)
            return [result]
        return [self._with_shape(result)]

    def _with_shape(self, contact: Contact) -> Contact:
        grid_mm = self.soft.domain.grid_mm
        return dataclasses.replace(
            contact,
            object_mm=np.stack(self.shapes[: len(contact.reaction_N)]).astype(np.float32),
            object_origin_mm=self.soft.first_cell * grid_mm,
            object_spacing_mm=grid_mm,
        )


def _shape(
    soft: SoftObject, nodal_mm: np.ndarray, pose: tuple[np.ndarray, np.ndarray]
) -> np.ndarray:
    """Displacement at the lattice places in the body frame of a pose [mm], shape (A, B, C, 3).

    Places without a cell move as the nearest place with one.
    """
    from scipy.ndimage import distance_transform_edt

    shape = soft.cell_map.shape
    index = np.stack(np.meshgrid(*[np.arange(n) for n in shape], indexing="ij"), axis=-1)
    places = (index.reshape(-1, 3) + soft.first_cell) * soft.domain.grid_mm
    cell = cells_at(soft, places)
    known = np.flatnonzero(cell >= 0)
    moved = np.zeros((len(places), 3))
    moved[known] = deformed(soft, nodal_mm, places[known], cell[known])[0]
    origin, rotation = pose
    now = ((places + moved) @ soft.rotation.T + soft.origin_mm - origin) @ rotation
    way = (now - places).reshape(*shape, 3)
    nearest = distance_transform_edt(soft.cell_map < 0, return_distances=False, return_indices=True)
    return way[tuple(np.asarray(nearest))]
