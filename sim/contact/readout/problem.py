"""A press made ready to be solved: object, path, surface points and active region."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim.contact.engine.memory import check_memory
from sim.contact.motion.approach import Approach
from sim.contact.objects.collider import Collider
from sim.contact.readout.verdict import check_depth
from sim.contact.region.backing import (
    SIDEWAYS,
    backed_faces,
    bonded_faces,
    foundation_N_mm3,
    support_points_mm,
)
from sim.contact.region.domain import Domain, Region, build_domain
from sim.contact.region.drives import driven_faces, drives_inner, farthest_drive_mm
from sim.contact.region.halving import Halved, locate
from sim.contact.region.materials import stiffest_MPa, young_MPa_at
from sim.contact.region.placing import place_object
from sim.contact.region.quadrature import (
    Facets,
    SurfacePoints,
    corner_points,
    facets_of,
    join,
    merge,
)
from sim.contact.region.radius import region_radius_mm
from sim.contact.region.refinement import (
    LONGEST_EDGE,
    path_distance_mm,
    reach_mm,
    refine,
    refine_within,
)
from sim.contact.region.small_contacts import halved_cells, small_overlaps
from workbench.core.design.design import Elastomer
from workbench.core.press.press import ContactSettings, Press
from workbench.core.press.press_case import PressCase
from workbench.core.result.results import MaterialPoints, MembraneMesh
from workbench.core.result.sampled import SampledDistance

BORDER_CELLS = 4.0
"""Cells so near the edge of the region are not halved."""
HELD_CELLS = 1.5
"""The same of cells so near the inner skin."""
BOND_PENALTY = 100.0
"""Stiffness of the bond to the support per area, in units of E / grid."""
DRIVE_PENALTY = 20.0
"""The same for driven faces: an actuator's pad gives a little, and large turns stay stable."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Problem:
    """One press, ready."""

    mesh: MembraneMesh
    material: Elastomer
    settings: ContactSettings
    approach: Approach
    domain: Domain
    radius_mm: float

    @property
    def press(self) -> Press:
        """The path."""
        return self.approach.press

    @property
    def collider(self) -> Collider:
        """The object."""
        return self.approach.collider


def make_problem(
    mesh: MembraneMesh,
    points: MaterialPoints,
    material: Elastomer,
    case: PressCase,
    sampled: SampledDistance | None = None,
) -> Problem:
    """Place the object and number the region.

    Args:
        mesh: Skins and gap.
        points: Material points.
        material: The elastomer.
        case: The object, its path; region and penalty.
        sampled: The object's distance on this grid where a store has it; else it is sampled here.

    Raises:
        DesignError: If the target is off the skin, the object cannot be made or would reach the
            support, the region is too small, a driven region does not exist, or memory is short.
        SolveError: If the first touch cannot be found.
    """
    approach = place_object(
        mesh.outer, case.indenter, case.press, grid_mm=points.grid_mm, sampled=sampled
    )
    check_depth(support_points_mm(mesh), approach)
    settings = case.settings
    radius_mm = region_radius_mm(mesh, material, approach, settings)
    return Problem(
        mesh=mesh,
        material=material,
        settings=settings,
        approach=approach,
        domain=prepare(mesh, points, material, approach, settings, radius_mm=radius_mm),
        radius_mm=radius_mm,
    )


def prepare(
    mesh: MembraneMesh,
    points: MaterialPoints,
    material: Elastomer,
    approach: Approach,
    settings: ContactSettings,
    *,
    radius_mm: float,
) -> Domain:
    """Surface points that may take part, and the active region around them."""
    grid_mm = points.grid_mm
    check_memory(points, approach.target_mm, radius_mm)
    facets = contact_facets(mesh, approach, grid_mm, radius_mm=radius_mm)
    halved = _halved(mesh, points, approach, facets, radius_mm=radius_mm)
    facets = refine_within(facets, halved, grid_mm=grid_mm)
    held = contact_points(mesh, facets, approach, grid_mm)
    # Springs are as stiff as the cells around them are fine.
    finer = 2.0 ** locate(held.position_mm / grid_mm, halved).level
    young_MPa = young_MPa_at(material, mesh.outer, held.position_mm)
    held = held.scaled(settings.penalty / grid_mm * finer * young_MPa)
    for group in held_points(mesh, material, approach, grid_mm, radius_mm=radius_mm):
        held = join(held, group)
    return build_domain(
        mesh,
        points,
        held,
        material,
        region=Region(centre_mm=approach.target_mm, radius_mm=radius_mm, halved=halved),
        inner_moves=mesh.backing_mm > 0.0 or drives_inner(mesh, approach.press),
    )


def contact_facets(
    mesh: MembraneMesh, approach: Approach, grid_mm: float, *, radius_mm: float
) -> Facets:
    """Triangles of the outer skin, fine where the object comes near."""
    centre = mesh.outer.points_mm[mesh.outer.faces].mean(axis=1)
    near = np.flatnonzero(_near(centre, approach, radius_mm, grid_mm))
    facets = facets_of(mesh.outer, near, spacing_mm=LONGEST_EDGE * grid_mm)
    return refine(facets, approach, grid_mm=grid_mm)


def contact_points(
    mesh: MembraneMesh, facets: Facets, approach: Approach, grid_mm: float
) -> SurfacePoints:
    """Points of the outer skin that the object comes near: others get no spring and no mass."""
    points = corner_points(facets, stiffness_N_mm3=1.0, bonded=False)
    gap_mm = path_distance_mm(points.position_mm, approach)
    reached_mm = reach_mm(approach, grid_mm) + farthest_drive_mm(mesh, approach.press)
    return points.take(gap_mm < reached_mm)


def _halved(
    mesh: MembraneMesh,
    points: MaterialPoints,
    approach: Approach,
    facets: Facets,
    *,
    radius_mm: float,
) -> Halved:
    """Cells that give way to finer ones, none of them at the edge of the region.

    Those at the inner skin stay whole too: it is held at a point for each whole cell.

    A soft object has cells as large as those that are whole, and meets no others.
    """
    from scipy.spatial import KDTree

    grid_mm = points.grid_mm
    soft = approach.collider.soft
    overlaps = [] if soft else small_overlaps(facets, approach, grid_mm=grid_mm)
    if not overlaps:
        return ()

    inner = KDTree(mesh.inner.points_mm)

    def within(places_mm: np.ndarray) -> np.ndarray:
        from_target_mm = np.linalg.norm(places_mm - approach.target_mm, axis=1)
        to_inner_mm = inner.query(places_mm, distance_upper_bound=HELD_CELLS * grid_mm)[0]
        return (from_target_mm < radius_mm - BORDER_CELLS * grid_mm) & np.isinf(to_inner_mm)

    cells_mm = points.cells * grid_mm
    active = np.linalg.norm(cells_mm - approach.target_mm, axis=1) < radius_mm
    return halved_cells(overlaps, points.cells[active], grid_mm=grid_mm, within=within)


def held_points(
    mesh: MembraneMesh,
    material: Elastomer,
    approach: Approach,
    grid_mm: float,
    *,
    radius_mm: float,
) -> list[SurfacePoints]:
    """Points bonded to the support, resting on gel, or driven by an actuation of the press."""
    unit = stiffest_MPa(material) / grid_mm
    spacing_mm = LONGEST_EDGE * grid_mm
    outer_drives, inner_drives = driven_faces(mesh, approach.press)
    free = inner_drives < 0
    groups = [
        (mesh.inner, bonded_faces(mesh) & free, BOND_PENALTY * unit, 1.0, -1),
        (mesh.inner, backed_faces(mesh) & free, foundation_N_mm3(mesh, material), SIDEWAYS, -1),
    ]
    for drive in range(len(approach.press.actuations)):
        for skin, drives in ((mesh.outer, outer_drives), (mesh.inner, inner_drives)):
            groups.append((skin, drives == drive, DRIVE_PENALTY * unit, 1.0, drive))
    found = []
    for skin, chosen, stiffness_N_mm3, sideways, drive in groups:
        centre = skin.points_mm[skin.faces].mean(axis=1)
        members = np.flatnonzero(chosen & _near(centre, approach, radius_mm, grid_mm))
        if stiffness_N_mm3 > 0.0 and len(members):
            facets = facets_of(skin, members, spacing_mm=spacing_mm)
            points = corner_points(
                facets,
                stiffness_N_mm3=stiffness_N_mm3,
                bonded=True,
                sideways=sideways,
                drive=drive,
            )
            found.append(merge(points, grid_mm))
    return found


def _near(
    places_mm: np.ndarray, approach: Approach, radius_mm: float, grid_mm: float
) -> np.ndarray:
    distance = np.linalg.norm(places_mm - approach.target_mm, axis=1)
    return distance < radius_mm + 2.0 * grid_mm
