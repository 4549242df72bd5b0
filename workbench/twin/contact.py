"""A twin pressed: its mesh, and the forces and displacements of a path, from the store."""

from __future__ import annotations

from workbench.calibration.stored import stored
from workbench.core.base.errors import MeshingError
from workbench.core.base.monitor import Monitor, part
from workbench.core.press.fem import FemSettings
from workbench.core.press.press_case import PressCase
from workbench.core.result.force_field import ForceField, from_contact
from workbench.core.result.results import MembraneMesh
from workbench.pipeline.stages.mesh import mesh_at
from workbench.pipeline.store import Store
from workbench.planning.plan import InlineRunner, plan
from workbench.twin.cases import TwinCase
from workbench.twin.draw import Twin
from workbench.twin.twin_plan import Solver, TwinPlan


def twin_mesh(twin: Twin, plan_: TwinPlan, store: Store, monitor: Monitor) -> MembraneMesh:
    """The mesh on which a twin is pressed and seen.

    Raises:
        MeshingError: If finite elements are asked for and the body cannot be divided so.
    """
    if plan_.contact is Solver.MPM:
        return stored(twin.design, PressCase(), "mesh", store, monitor)
    stored(twin.design, PressCase(), "build", store, part(monitor, 0.0, 0.5))
    call = mesh_at(plan(twin.design, PressCase())["build"].ref, plan_.hex_mm)
    InlineRunner(store).run(call, part(monitor, 0.5, 1.0))
    found: MembraneMesh = store.load("mesh", call.key)
    if found.hexes is None:
        raise MeshingError(
            f"this body has no hexahedra for finite elements: {found.notice}",
            hint="press it by the contact solver: --contact mpm",
            at="--contact",
        )
    return found


def pressed(
    twin: Twin, plan_: TwinPlan, case: TwinCase, store: Store, monitor: Monitor
) -> ForceField:
    """All frames of a path.

    Raises:
        DesignError, SolveError: If the object does not fit there, or a frame does not converge.
    """
    given = PressCase(
        indenter=case.indenter,
        press=case.press,
        fem=FemSettings(hex_mm=plan_.hex_mm, error=False),
    )
    if plan_.contact is Solver.MPM:
        return from_contact(stored(twin.design, given, "press", store, monitor))
    return stored(twin.design, given, "fem", store, monitor)


def seen_displacement_mm(mesh: MembraneMesh, field: ForceField):
    """Displacement of the vertices of `mesh.seen` in each frame [mm], shape (K, V, 3)."""
    return field.inner_mm if len(mesh.tips_mm) else field.displacement_mm
