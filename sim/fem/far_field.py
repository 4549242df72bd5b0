"""The part of a body that hardly strains, as springs between the nodes where it meets the rest.

Away from the contact the stiffness of a bonded wall stays what it is at rest, to a percent. With
the far nodes F eliminated from the tangent once, only the near ones N are left to factorise at each
step (static condensation, Guyan 1965):

    S = K_BB - K_BF K_FF^-1 K_FB,

B the near nodes that belong to a far element too. The residual stays that of all elements, exact
and nonlinear, so a solution is the same as without; what an approximate tangent costs is a step.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from sim.fem.body import Body
from sim.fem.elements import evaluate
from sim.fem.factors import LinearSolver
from sim.fem.linear_solver import make_solver
from sim.fem.sparse_system import System, make_system

COLUMNS = 128
"""Right-hand sides at once."""


@dataclass(frozen=True, kw_only=True)
class FarField:
    """Far elements at rest, condensed."""

    system: System
    """Numbering and pattern of the near equations; nodes B all meet each other."""
    near: np.ndarray
    """Their numbers among the free equations of the body, shape (A,)."""
    far: np.ndarray
    """Numbers of the equations that are eliminated, shape (F,)."""
    border: np.ndarray
    """Near equations that far elements touch, counted among the near ones, shape (B,)."""
    border_nodes: np.ndarray
    """The nodes they belong to, shape (B / 3,)."""
    stiffness_N_mm: np.ndarray
    """S, shape (B, B)."""
    link: Any
    """K_FB in CSR form, shape (F, B)."""
    factors: LinearSolver
    """Of K_FF, in float32 and not refined: they say where to step, the residual is exact."""

    def near_part(self, right_N: np.ndarray) -> np.ndarray:
        """Right-hand side of the near equations, (A,), of one of all free equations, (E,)."""
        found = right_N[self.near]
        found[self.border] -= self.link.T @ self._far_part(right_N[self.far])
        return found

    def whole(self, right_N: np.ndarray, near_mm: np.ndarray) -> np.ndarray:
        """Solution of all free equations, (E,), from that of the near ones, (A,)."""
        found = np.empty_like(right_N)
        found[self.near] = near_mm
        rest_N = right_N[self.far] - self.link @ near_mm[self.border]
        found[self.far] = self._far_part(rest_N)
        return found

    def _far_part(self, right_N: np.ndarray) -> np.ndarray:
        return self.factors.solve_many(right_N[:, None])[:, 0]

    def close(self) -> None:
        """Give the memory of the factors back."""
        self.factors.close()


def condense(body: Body) -> FarField:
    """Eliminate what lies beyond the near elements of a body.

    Raises:
        SolveError: If the linear solver fails.
    """
    cells, near_cells = body.elements.cells, body.elements.cells[: body.near]
    close_by = np.zeros(len(body.points_mm), dtype=bool)
    close_by[near_cells] = True
    beyond = np.zeros_like(close_by)
    beyond[cells[body.near :]] = True
    nodes = np.flatnonzero(close_by & beyond & ~body.held)
    system = make_system(len(body.points_mm), near_cells, body.held | ~close_by, joined=nodes)
    near = np.searchsorted(body.system.free, system.free)
    far = np.setdiff1d(np.arange(len(body.system.free)), near, assume_unique=True)
    border = (3 * system.numbers[nodes][:, None] + np.arange(3)).ravel()
    at_rest = _rest_stiffness(body)
    columns = near[border]
    below = at_rest[far]
    link = below[:, columns].tocsr()
    factors = make_solver(symmetric=True, positive=True, single=True)
    factors.factorise(below[:, far].tocsr())
    stiffness = at_rest[columns][:, columns].toarray()
    for begin in range(0, len(border), COLUMNS):
        part = slice(begin, begin + COLUMNS)
        stiffness[:, part] -= link.T @ factors.solve_many(link[:, part].toarray())
    return FarField(
        system=system,
        near=near,
        far=far,
        border=border,
        border_nodes=nodes,
        stiffness_N_mm=0.5 * (stiffness + stiffness.T),
        link=link,
        factors=factors,
    )


def _rest_stiffness(body: Body) -> Any:
    """Stiffness of the far elements at rest by all free equations, CSR, shape (E, E)."""
    distant = body.elements.take(slice(body.near, None))
    state = evaluate(distant, np.zeros_like(body.points_mm), tangent=True)
    assert state.tangent_N_mm is not None
    return body.system.matrix((body.system.slots(distant.cells), state.tangent_N_mm))
