"""One press of an object, by the method that its settings name."""

from __future__ import annotations

from sim.contact.readout.problem import make_problem
from sim.contact.solver.solver import solve
from workbench.core.base.errors import SolveError
from workbench.core.base.monitor import Monitor, silent
from workbench.core.design.design import Elastomer
from workbench.core.press.press import Method
from workbench.core.press.press_case import PressCase
from workbench.core.result.results import MaterialPoints, MembraneMesh
from workbench.core.result.sampled import SampledDistance
from workbench.core.result.sensing import Contact


def press_membrane(
    mesh: MembraneMesh,
    points: MaterialPoints,
    material: Elastomer,
    case: PressCase,
    *,
    sampled: SampledDistance | None = None,
    monitor: Monitor = silent,
) -> Contact:
    """Press an object along its path; Taichi must have been initialised in this thread.

    Args:
        mesh: Skins: contact on `outer`, bond or gel on `inner`.
        points: Material points; their `grid_mm` is the grid of the solution.
        material: The elastomer, with its friction against the object.
        case: The object, its path, the regions that are driven meanwhile; region, penalty,
            tolerance.
        sampled: The object's distance on this grid where a store has it; else it is sampled here.
        monitor: Told the frame and residual; raises `Cancelled` to stop.

    Raises:
        DesignError: If the target is off the skin, the object cannot be made or would reach the
            support, the region is too small, or memory is short.
        SolveError: If a frame does not settle or is not sound; carries frame, residual, last
            good frame, and the result of the frames that settled.
    """
    if case.settings.method is Method.PARTICLES:
        from sim.contact.particles.press import press_particles

        return press_particles(mesh, points, material, case, monitor=monitor)
    monitor(0.0, "placing the object")
    problem = make_problem(mesh, points, material, case, sampled)
    if case.indenter.soft is not None:
        from sim.contact.soft.solver import press_soft

        result = press_soft(problem, case.indenter, monitor)
    else:
        (result,) = solve([problem], monitor=monitor)
    if isinstance(result, SolveError):
        raise result
    return result
