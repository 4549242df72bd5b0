"""Adaptive dynamic relaxation: damped motion with fictitious masses until forces balance.

    v <- ((2 - d) v + 2 f / m) / (2 + d),  u <- u + v,  d = 2 sqrt(l),  l = v.(f_old - f) / v.m v

with a time step of 1; l, the Rayleigh quotient of the last step, estimates the lowest frequency
that is still moving. Source: Underwood, Dynamic relaxation, 1983; Papadrakakis, 1981.
Each case of a batch has its own damping and masses. Nothing bulky leaves the device while it
relaxes: only the sums of `balances` do.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from sim.contact.engine import kernels, sum_kernels
from sim.contact.engine.balances import Balances
from sim.contact.engine.batch import Batch, Case, floats
from sim.contact.engine.launcher import STEPS, Launcher
from sim.contact.grid import layout
from sim.forces.slip import LEAST_MM

STEP_CAP = 0.1
"""Largest displacement of a node in one substep and axis, in cells."""
FIRST_DAMPING = 0.5
DAMPING_RANGE = (0.004, 1.5)
OPEN = -1.0
"""In place of the way from which points slide: of a case whose frame is not to be closed."""


class Relaxation:
    """Displacement, velocity and contact history of a batch of presses on the device."""

    def __init__(self, cases: list[Case]) -> None:
        self.cases = cases
        self.batch = batch = Batch(cases, STEPS)
        count = len(cases)
        self.damping = np.full(count, FIRST_DAMPING)
        self.mass_scale = np.ones(count)
        self._moved = np.zeros(count, bool)
        self._poses = np.zeros((STEPS, count, layout.POSE), np.float32)
        self._poses[:, :, 3::4] = 1.0
        self._numbers = np.zeros((count, layout.NUMBERS), np.float32)
        self._choices = np.zeros((count, layout.CHOICES), np.int32)
        self._modes = np.zeros(count, np.int32)
        self._seats_mm = np.array([case.collider.seat_mm for case in cases])
        self._targets_mm = np.array([case.domain.target_mm for case in cases])
        for row, case in enumerate(cases):
            grid_mm = case.domain.grid_mm
            sliding = case.kinetic_friction
            self._numbers[row, layout.FRICTION] = case.friction
            self._numbers[row, layout.KINETIC] = case.friction if sliding is None else sliding
            self._numbers[row, layout.LARGEST_STEP] = STEP_CAP * grid_mm
            self._numbers[row, layout.INVERSE_EDGE] = 1.0 / grid_mm
            self._numbers[row, layout.SIZE :] = case.collider.seated_size
            self._choices[row, layout.SHAPE] = int(case.collider.shape)
            self._choices[row, layout.FIRST_COEFFICIENT] = batch.first_coefficients[row]
            self._choices[row, layout.COUNTS :] = case.collider.samples.shape
        self._closing = np.full(count, OPEN, np.float32)
        self._sliding = floats(self._closing)
        self._known: dict[int, np.ndarray] = {}  # Displacements that no substep has changed since.
        self._stale_poses = True
        self._sent = (np.zeros(0), np.zeros(0))
        self._substep = self._launcher()

    def _launcher(self) -> Launcher:
        """What runs the substeps."""
        tied = self.batch.ties is not None
        made = kernels.tied_substep_of if tied else kernels.substep_of
        return Launcher(made(_one_law(self.cases)), self.batch.bundles, cases=len(self.cases))

    def set_poses(self, case: int, rows: np.ndarray) -> None:
        """Poses of a case in the next substeps, shape (n <= STEPS, POSE); the last one stays.

        A row is origin [mm, sensor frame], rotation body to sensor by rows, share of the drives.
        """
        padding = np.repeat(rows[-1:], STEPS - len(rows), axis=0)
        self.set_all_poses(np.array([case]), np.concatenate([rows, padding])[None])

    def set_all_poses(self, cases: np.ndarray, rows: np.ndarray) -> None:
        """The same of several cases, (n,), at once: rows of shape (n, STEPS, POSE)."""
        self._close()
        rotations = rows[..., 3:12].reshape(*rows.shape[:2], 3, 3)
        seats_mm = np.einsum("nsrc,nc->nsr", rotations, self._seats_mm[cases])
        table = rows.astype(np.float32)
        table[..., :3] = rows[..., :3] + seats_mm - self._targets_mm[cases][:, None]
        self._poses[:, cases] = table.transpose(1, 0, 2)
        self._stale_poses = True

    def advance(self, moving: np.ndarray) -> None:
        """`STEPS` substeps of the cases that are marked, (B,) bool; the others stay as they are."""
        self._known.clear()
        self._prepare(np.where(moving, layout.MOVING, layout.IDLE))
        self._substep.run(STEPS)
        self._moved = self._moved | moving

    def evaluate(self, chosen: np.ndarray) -> Balances:
        """Forces of the chosen cases, (B,) bool, at their displacements and first poses."""
        self._prepare(np.where(chosen, layout.STILL, layout.IDLE))
        self._substep.run(1)
        self._moved = self._moved & ~chosen
        return self.balances(np.zeros(len(self.cases), bool))

    def balances(self, adapting: np.ndarray, falling: np.ndarray | None = None) -> Balances:
        """Forces of the last substep; adapts the damping of the marked cases, (B,), that moved.

        Args:
            adapting: Whose damping is adapted, (B,) bool.
            falling: Whose damping may only fall. Near rest most of what still moves is rounding, of
                the highest frequencies; damped as these ask, what is left to settle would creep.
        """
        nodes, surface = self.batch.sums.read()
        work, inertia = nodes[:, 0], nodes[:, 1]
        with np.errstate(divide="ignore", invalid="ignore"):
            lowest = np.maximum(work / inertia, 0.0)
        adapted = np.clip(2.0 * np.sqrt(lowest), *DAMPING_RANGE)
        known = adapting & self._moved & (inertia > 0.0) & np.isfinite(adapted)
        if falling is not None:
            adapted = np.where(falling, np.minimum(adapted, self.damping), adapted)
        self.damping = np.where(known, adapted, self.damping)
        return Balances(
            reaction_N=-surface[:, :3],
            held_N=surface[:, 3:],
            unbalanced_N=np.sqrt(nodes[:, 2]),
            net_N=nodes[:, 3:],
            inertia_Nmm=inertia,
        )

    def commit(self, case: int, *, slid_mm: float = LEAST_MM) -> None:
        """Make the anchors of a settled frame, at its first pose, the history of the next.

        Done before anything of the batch changes or is read of its history, not at once.

        Args:
            case: Whose.
            slid_mm: Way since the last commit from which a point counts as sliding, so that
                kinetic friction holds it.
        """
        self._closing[case] = slid_mm

    def _close(self) -> None:
        """Close the frames that are due, all at once; a case would take as long as all."""
        if (self._closing >= 0.0).any():
            self._upload()
            self._sliding.from_numpy(self._closing)
            kernels.commit_anchors(
                *self.batch.packs, self.batch.slips, self.batch.kept, self._sliding
            )
            self._closing[:] = OPEN

    def burden(self, chosen: np.ndarray) -> None:
        """Double the fictitious masses of the chosen cases, (B,) bool."""
        self.mass_scale[chosen] *= 2.0

    def relieve(self, case: int) -> None:
        """Halve the burden of a case, never below its own masses: a stall may not come again."""
        self.mass_scale[case] = max(1.0, 0.5 * self.mass_scale[case])

    def snapshot(self, case: int) -> np.ndarray:
        """What `restart` takes to come back to the present displacement, shape (N, 3)."""
        return self.displacement(case)

    def restart(self, case: int, displacement_mm: np.ndarray) -> None:
        """Come to rest at a nodal displacement, (N, 3); anchors of this frame are lost."""
        self._close()
        first = 3 * self.batch.spans[case].first_node
        self.batch.write(self.batch.nodes.displacement, first, displacement_mm)
        self._rest(case)

    def go_back(self, case: int) -> None:
        """Come to rest at the displacement of the last commit; anchors since then are lost."""
        self._close()
        span, moved = self.batch.spans[case], self.batch.nodes.displacement
        sum_kernels.copy_back(self.batch.kept, moved, 3 * span.first_node, 3 * span.nodes)
        self._rest(case)

    def _rest(self, case: int) -> None:
        """Stop a case whose displacement is another one now."""
        self._known.pop(case, None)
        span = self.batch.spans[case]
        sum_kernels.rest(
            self.batch.nodes.velocity, self.batch.surface.states, span.first_node, span.nodes,
            span.first_point, span.points,
        )  # fmt: skip
        self._moved[case] = False
        self.damping[case] = FIRST_DAMPING

    def drive(self, case: int, start_mm: np.ndarray, end_mm: np.ndarray) -> None:
        """Where held points belong at share 0 and 1 of the coming frame, each (P, 3)."""
        goals = np.concatenate([start_mm, end_mm], axis=1)
        self.batch.write(self.batch.surface.goals, 6 * self.batch.spans[case].first_point, goals)

    def displacement(self, case: int = 0) -> np.ndarray:
        """Nodal displacement of a case [mm], shape (N, 3), float32."""
        if case not in self._known:
            self._known[case] = self._of_nodes(self.batch.nodes.displacement, case)
        return self._known[case]

    def node_forces(self, case: int = 0) -> np.ndarray:
        """Force on every node of a case [N], shape (N, 3), float32."""
        return self._of_nodes(self.batch.nodes.forces, case)

    def point_forces(self, case: int = 0) -> np.ndarray:
        """Force on the membrane at every surface point of a case [N], shape (P, 3), float32."""
        return self._of_points(self.batch.surface.point_forces, case, 3)

    def slips_mm(self, case: int = 0) -> np.ndarray:
        """Way that each surface point has slid in settled frames [mm], shape (P,)."""
        self._close()
        return self._of_points(self.batch.slips, case, 1)[:, 0]

    def contact_history(self, case: int = 0) -> tuple[np.ndarray, np.ndarray]:
        """Anchors in the body frame [mm], (P, 3), and states, (P,), of all surface points."""
        self._close()
        span, surface = self.batch.spans[case], self.batch.surface
        states = self.batch.read_whole(surface.states, span.first_point, span.points)
        return self._of_points(surface.anchors, case, 3) + self.cases[case].collider.seat_mm, states

    def _of_nodes(self, array: Any, case: int) -> np.ndarray:
        span = self.batch.spans[case]
        return self.batch.read(array, 3 * span.first_node, 3 * span.nodes).reshape(-1, 3)

    def _of_points(self, array: Any, case: int, width: int) -> np.ndarray:
        span = self.batch.spans[case]
        first, count = width * span.first_point, width * span.points
        return self.batch.read(array, first, count).reshape(-1, width)

    def _prepare(self, modes: np.ndarray) -> None:
        self._close()
        self._numbers[:, layout.MASS_SCALE] = self.mass_scale
        self._numbers[:, layout.DAMPING] = self.damping
        self._modes = modes
        self._upload()

    def _upload(self) -> None:
        self._choices[:, layout.MODE] = self._modes
        numbers, choices = self._sent
        # A copy to the device costs as much as a substep of a small case: send what changed.
        if not np.array_equal(choices, self._choices):
            self.batch.cases.choices.from_numpy(self._choices.ravel())
        if not np.array_equal(numbers, self._numbers):
            self.batch.cases.numbers.from_numpy(self._numbers.ravel())
        self._sent = (self._numbers.copy(), self._choices.copy())
        if self._stale_poses:
            self.batch.cases.poses.from_numpy(self._poses.ravel())
            self._stale_poses = False


def _one_law(cases: list[Case]) -> bool:
    """Whether the law of all cases is the linear one."""
    laws = {case.domain.linear for case in cases}
    if len(laws) > 1:
        raise ValueError("a batch holds linear and neo-Hookean cases; solve them apart")
    return laws.pop()
