"""The linearised equations of a body: assembled, condensed and solved.

Exact for the near elements, the contact and the gel; of far elements the stiffness at rest, once
eliminated (`far_field`).
"""

from __future__ import annotations

import functools
from typing import Any

import numpy as np

from sim.fem.balance import Balance
from sim.fem.body import Body
from sim.fem.factors import LinearSolver
from sim.fem.far_field import FarField, condense
from sim.fem.linear_solver import make_solver
from sim.fem.sparse_system import System


class Tangent:
    """Derivative of minus the residual of a body by its free displacements.

    It remembers the order of the equations, and holds memory until it is closed.
    """

    def __init__(self, body: Body, *, device: str = "cpu") -> None:
        """Make it ready.

        Args:
            body: The body.
            device: `cpu`, or `cuda` to factorise there.
        """
        self.body, self._device = body, device
        self._solvers: dict[bool, LinearSolver] = {}
        self._symmetric = False
        self.met: tuple[np.ndarray, np.ndarray] | None = None
        """Faces that touch in the last factors, shape (F,), and the stiffness of contact that
        those hold, shape (F, 12, 12); None where there are no factors."""

    @property
    def solver_name(self) -> str:
        """Of the linear solver, for people; of none where there was nothing to solve."""
        used = self._solvers.get(False) or self._solvers.get(True)
        return "nothing to solve" if used is None else used.name

    def _solver(self, *, symmetric: bool) -> LinearSolver:
        """Made at its first use: it depends on how many equations are near."""
        if symmetric not in self._solvers:
            self._solvers[symmetric] = make_solver(
                symmetric=symmetric,
                single=True,
                block=self._far is not None,
                device=self._device,
                equations=len(self._system.free),
            )
        return self._solvers[symmetric]

    def factorise(
        self, state: Balance, *, symmetric: bool = False, elements_N_mm: np.ndarray | None = None
    ) -> int | None:
        """Linearise about a state.

        Args:
            state: Forces with tangents.
            symmetric: Whether the tangent is: friction is held.
            elements_N_mm: Stiffnesses of the near elements instead of the state's own, shape
                (L, 24, 24).

        Returns:
            Number of negative pivots of a symmetric tangent, where the solver counts them.
        """
        self._symmetric = symmetric
        matrix = self.matrix(state, elements_N_mm)
        assert state.face_N_mm is not None
        self.met = state.touching_faces, state.face_N_mm
        return self._solver(symmetric=symmetric).factorise(matrix)

    def forget(self) -> None:
        """Let nobody use the last factors again."""
        self.met = None

    def solve(self, right_N: np.ndarray) -> np.ndarray:
        """Way of all nodes, shape (N, 3), that answers forces at the free equations, (E,)."""
        far, solver = self._far, self._solver(symmetric=self._symmetric)
        if far is None:
            return self.body.system.expanded(solver.solve(right_N))
        near_mm = solver.solve(far.near_part(right_N))
        return self.body.system.expanded(far.whole(right_N, near_mm))

    def matrix(self, state: Balance, elements_N_mm: np.ndarray | None = None) -> Any:
        """The matrix that `factorise` takes, CSR, of the near equations."""
        if elements_N_mm is None:
            elements_N_mm = state.elements.tangent_N_mm
        assert elements_N_mm is not None and state.face_N_mm is not None
        found = self._system.matrix(
            (self._cell_slots, elements_N_mm),
            (self._face_slots[state.touching_faces], state.face_N_mm),
        )
        found.data += self._constant
        return found

    def close(self) -> None:
        """Give the memory of the factors back."""
        self.forget()
        for solver in self._solvers.values():
            solver.close()
        if "_far" in self.__dict__ and self._far is not None:
            self._far.close()

    @functools.cached_property
    def _far(self) -> FarField | None:
        """None where all elements are near."""
        return condense(self.body) if self.body.near < len(self.body.elements.cells) else None

    @property
    def _system(self) -> System:
        return self.body.system if self._far is None else self._far.system

    @functools.cached_property
    def _cell_slots(self) -> np.ndarray:
        """Where stiffnesses of near elements go, shape (L, 24, 24)."""
        return self._system.slots(self.body.elements.cells[: self.body.near])

    @functools.cached_property
    def _face_slots(self) -> np.ndarray:
        """Where stiffnesses of contact faces go, shape (Q, 12, 12); of far faces nowhere."""
        return self._system.slots(self.body.faces.nodes)

    @functools.cached_property
    def _constant(self) -> np.ndarray:
        """What gel and far field add to the entries of the matrix, shape (Z,)."""
        body, system = self.body, self._system
        found = system.matrix((system.slots(body.springs.nodes), body.spring_N_mm)).data
        if self._far is not None:
            slots = system.slots(self._far.border_nodes[None])
            found += system.matrix((slots, self._far.stiffness_N_mm[None])).data
        return found
