"""The patch test: irregular elements reproduce a state of constant strain to machine precision.

The outer nodes of a block are moved linearly, x -> F x, and the inner ones found by Newton's
method; the solution is u(x) = (F - I) x everywhere, and the force on a side is P N per area.
Source: Irons and Razzaque (1972), in the finite strain of Nagtegaal, Parks and Rice (1974).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim.fem.elements import Elements, evaluate, make_elements
from sim.fem.linear_solver import SuperLU
from sim.fem.sparse_system import make_system
from sim.fem.studies.blocks import SEED, irregular_block
from sim.fem.submodel import boundary
from sim.material import elastic_solid, first_piola
from workbench.core.design.design import Elastomer, Law

STRETCH = np.array([[0.35, 0.25, -0.1], [0.1, -0.2, 0.15], [-0.05, 0.3, 0.1]])
"""F - I of the finite strain: a third of stretch, a quarter of shear and 25 degrees of turning."""
START = 0.1
"""Free nodes begin this far off, over the largest entry of H [mm]."""
STEPS = 8


@dataclass(frozen=True, kw_only=True, slots=True)
class Patch:
    """How far a solved patch is from its exact state."""

    displacement: float
    """Largest error of a node over the largest displacement."""
    force: float
    """Error of the force on the side x = 1 over that force."""
    off: float
    """Largest distance, over the largest displacement, of the start from the solution."""


def solve_patch(gradient: np.ndarray = STRETCH, *, law: Law = Law.NEO_HOOKEAN) -> Patch:
    """Solve the patch for H = F - I, shape (3, 3)."""
    solid = elastic_solid(Elastomer(law=law))
    points_mm, cells = irregular_block()
    elements = make_elements(
        points_mm,
        cells,
        shear_MPa=solid.shear_MPa,
        bulk_MPa=solid.bulk_MPa,
        linear=solid.linear,
    )
    held = np.isin(np.arange(len(points_mm)), boundary(cells))
    exact_mm = points_mm @ gradient.T
    shift_mm = np.random.default_rng(SEED).uniform(-1.0, 1.0, points_mm.shape) * START
    start_mm = exact_mm + np.where(held[:, None], 0.0, shift_mm * np.abs(gradient).max())
    found_mm = _relaxed(elements, held, start_mm)
    forces = evaluate(elements, found_mm).force_N
    nodal_N = make_system(len(points_mm), cells, held).gather(cells, forces)
    side_N = nodal_N[points_mm[:, 0] == 1.0].sum(axis=0)
    exact_N = first_piola(gradient, solid) @ [1.0, 0.0, 0.0]
    most_mm = float(np.abs(exact_mm).max())
    return Patch(
        displacement=float(np.abs(found_mm - exact_mm).max()) / most_mm,
        force=float(np.linalg.norm(side_N - exact_N) / np.linalg.norm(exact_N)),
        off=float(np.abs(start_mm - exact_mm).max()) / most_mm,
    )


def _relaxed(elements: Elements, held: np.ndarray, displacement_mm: np.ndarray) -> np.ndarray:
    """Displacement (N, 3) at which the free nodes are in balance."""
    system = make_system(len(held), elements.cells, held)
    slots, solver = system.slots(elements.cells), SuperLU()
    for _ in range(STEPS):
        state = evaluate(elements, displacement_mm, tangent=True)
        assert state.tangent_N_mm is not None
        residual_N = system.reduced(system.gather(elements.cells, state.force_N))
        solver.factorise(system.matrix((slots, state.tangent_N_mm)))
        step_mm = system.expanded(solver.solve(residual_N))
        displacement_mm = displacement_mm - step_mm
    return displacement_mm
