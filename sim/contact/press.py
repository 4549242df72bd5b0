"""Presses of objects: one by the method that its settings name, or many side by side."""

from __future__ import annotations

from collections.abc import Sequence

from sim.contact.readout.problem import Problem, make_problem
from sim.contact.solver.solver import solve
from workbench.core.base.errors import DesignError, SolveError, WorkbenchError
from workbench.core.base.monitor import Monitor, silent
from workbench.core.design.design import Elastomer
from workbench.core.press.press import Method
from workbench.core.press.press_case import PressCase
from workbench.core.result.results import MaterialPoints, MembraneMesh
from workbench.core.result.sampled import SampledDistance
from workbench.core.result.sensing import Contact


def press_side_by_side(
    mesh: MembraneMesh,
    points: MaterialPoints,
    presses: Sequence[tuple[Elastomer, PressCase]],
    *,
    monitor: Monitor = silent,
) -> list[Contact | WorkbenchError]:
    """Many presses of rigid objects in one launch: each is what `press_membrane` makes of it.

    Args:
        mesh: As for `press_membrane`, for all of them.
        points: Likewise.
        presses: Elastomer and case of each; all of one law, linear or not.
        monitor: As for `press_membrane`.

    Returns:
        The contact of each press, or why it has none.

    Raises:
        Cancelled: If the monitor says so.
    """
    problems: dict[int, Problem] = {}
    found: list[Contact | WorkbenchError | None] = [None] * len(presses)
    for number, (material, case) in enumerate(presses):
        monitor(0.0, f"placing object {number + 1} of {len(presses)}")
        try:
            problems[number] = make_problem(mesh, points, material, case)
        except (DesignError, SolveError) as error:
            found[number] = error
    results = solve(list(problems.values()), monitor=monitor) if problems else []
    for number, result in zip(problems, results, strict=True):
        found[number] = result
    return [one for one in found if one is not None]


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
