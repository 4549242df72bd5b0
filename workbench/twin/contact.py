"""A twin pressed: its mesh, and the forces and displacements of a path, from the store."""

from __future__ import annotations

import dataclasses
import time

import numpy as np

from workbench.calibration.stored import stored
from workbench.core.base.digest import digest
from workbench.core.base.errors import MeshingError
from workbench.core.base.monitor import Monitor, part, silent
from workbench.core.objects.kind import Shape
from workbench.core.press.fem import FemSettings
from workbench.core.press.press_case import PressCase
from workbench.core.result.force_field import ForceField, from_contact
from workbench.core.result.results import MembraneMesh
from workbench.pipeline.devices import start_device
from workbench.pipeline.stage import Call
from workbench.pipeline.store import Store
from workbench.planning.plan import InlineRunner, plan
from workbench.planning.stage_table import STAGES
from workbench.twin.cases import TwinCase
from workbench.twin.draw import Twin
from workbench.twin.gent import LIMIT, VERSION, solve_hardening
from workbench.twin.twin_plan import Solver, TwinPlan

FEM = Solver.FEM.value
"""The stage of finite elements, which divides the body for itself."""
GENT = Solver.GENT.value
"""Where paths by Gent's law lie in the store."""
NEARER_MM = 10.0
"""Radius of the part that takes part where one of 12 mm has too many cells: fields are good to
some .005 mm, between the 9 and 12 mm of `FemSettings.radius_mm`."""
MOST_PAIRS = 1_000
"""Cells of twice the edge that may all be halved: `sim.fem.grading` adds no more than 8,000."""


def twin_mesh(twin: Twin, plan_: TwinPlan, store: Store, monitor: Monitor) -> MembraneMesh:
    """The mesh on which a twin is pressed and seen.

    Raises:
        MeshingError: If finite elements are asked for and the body cannot be divided so.
    """
    if plan_.contact is Solver.MPM:
        return stored(twin.design, PressCase(), "mesh", store, monitor)
    stored(twin.design, PressCase(), "build", store, part(monitor, 0.0, 0.5))
    given = PressCase(fem=FemSettings(hex_mm=plan_.hex_mm))
    press = plan(twin.design, given)[FEM]
    find_parts = STAGES[FEM].parts
    assert find_parts is not None
    call: Call = find_parts(press.inputs, store)["mesh"]
    InlineRunner(store).run(call, part(monitor, 0.5, 1.0))
    found: MembraneMesh = store.load("mesh", call.key)
    if found.hexes is None:
        raise MeshingError(
            f"this body has no hexahedra for finite elements: {found.notice}",
            hint="press it by the contact solver: --contact mpm",
            at="--contact",
        )
    return found


def fem_settings(mesh: MembraneMesh, case: TwinCase, hex_mm: float) -> FemSettings:
    """How a path is solved by finite elements.

    Cells under a contact are halved as the solver chooses. It knows objects by samples of their
    distance only near them, takes what is farther for near, and then halves nothing if that is too
    much; where it could come to that, cells of `hex_mm` are taken as they were meshed.

    Args:
        mesh: With hexahedra, paired.
        case: What is pressed where.
        hex_mm: Edge of a hexahedron.
    """
    settings = FemSettings(hex_mm=hex_mm, error=False)
    indenter = case.indenter
    closed_form = indenter.record.shape is not Shape.GRID
    if closed_form and not indenter.turned and not indenter.texture.raised:
        return settings
    if _pairs_within(mesh, case, settings.radius_mm) <= MOST_PAIRS:
        return settings
    nearer = dataclasses.replace(settings, radius_mm=NEARER_MM)
    if _pairs_within(mesh, case, NEARER_MM) <= MOST_PAIRS:
        return nearer
    return dataclasses.replace(nearer, halvings=0)


def _pairs_within(mesh: MembraneMesh, case: TwinCase, radius_mm: float) -> int:
    """Cells of twice the edge within a distance of where the object touches."""
    hexes = mesh.hexes
    if hexes is None:
        return 0
    middles = hexes.points_mm[hexes.cells[hexes.groups[:, 0]]].mean(axis=1)
    away_mm = np.linalg.norm(middles - np.array(case.press.target_mm), axis=1)
    return int(np.count_nonzero(away_mm < radius_mm))


def pressed(
    twin: Twin, plan_: TwinPlan, case: TwinCase, store: Store, monitor: Monitor
) -> ForceField:
    """All frames of a path, on the mesh of `twin_mesh`.

    Raises:
        DesignError, SolveError: If the object does not fit there, or a frame does not converge.
    """
    given = PressCase(indenter=case.indenter, press=case.press)
    if plan_.contact is Solver.MPM:
        return from_contact(stored(twin.design, given, "press", store, monitor))
    mesh = twin_mesh(twin, plan_, store, silent)
    given = dataclasses.replace(given, fem=fem_settings(mesh, case, plan_.hex_mm))
    if plan_.contact is Solver.GENT:
        return _hardening(twin, mesh, given, store, monitor)
    return stored(twin.design, given, FEM, store, monitor)


def _hardening(
    twin: Twin, mesh: MembraneMesh, given: PressCase, store: Store, monitor: Monitor
) -> ForceField:
    """A path of a gel of Gent's law, from the store or solved now."""
    press = plan(twin.design, given)[FEM]
    key = digest({"press": press.key, "limit": LIMIT, "version": VERSION})
    if store.has(GENT, key):
        return store.load(GENT, key)
    start_device(monitor)
    find_parts, sampled = STAGES[FEM].parts, None
    assert find_parts is not None
    call: Call | None = find_parts(press.inputs, store).get("sampled")
    if call is not None:
        InlineRunner(store).run(call, part(monitor, 0.0, 0.1))
        sampled = store.load(call.stage, call.key)
    begun = time.monotonic()
    material = press.inputs.material
    found = solve_hardening(mesh, material, given, part(monitor, 0.1, 1.0), sampled=sampled)
    store.save(GENT, key, found, seconds=time.monotonic() - begun, version=VERSION)
    return store.load(GENT, key)


def seen_displacement_mm(mesh: MembraneMesh, field: ForceField) -> np.ndarray:
    """Displacement of the vertices of `mesh.seen` in each frame [mm], shape (K, V, 3)."""
    return field.inner_mm if len(mesh.tips_mm) else field.displacement_mm
