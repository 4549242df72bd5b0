"""A soft object made ready: its lattice, the part that is held, and how to find its cells.

The lattice lies in the object's body frame as it is at the start of the press. The held part is
glued to a rigid holder that follows the path; it is held through its volume, by a spring for each
cell.
The object's own surface needs no points: the membrane's points feel its signed distance.
Left out: contact of the object with itself or with the support; textures finer than its lattice
deform as its lattice does.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass

import numpy as np

from sim.contact.grid.stencil import point_weights
from sim.contact.objects.collider import Collider
from sim.contact.objects.sampling import box_mm
from sim.contact.readout.problem import BOND_PENALTY, Problem
from sim.contact.region.domain import EIGENVALUE, Domain, Region, build_domain, stencil_nodes
from sim.contact.region.filling import fill
from sim.contact.region.materials import stiffest_MPa
from sim.contact.region.quadrature import SurfacePoints
from workbench.core.base.errors import DesignError
from workbench.core.design.design import Elastomer
from workbench.core.press.indenter import Indenter
from workbench.core.result.results import MaterialPoints, MembraneMesh, Skin

EVERYTHING_MM = 1e6
"""Radius of a region that leaves nothing out."""
STIFFEST_RATIO = 100.0
"""Modulus of the object over that of the membrane."""
CONTACT_MARGIN = 4.0
"""Twice for a spring that ends on two moving bodies, and twice because a patch may press on fewer
nodes than its area has."""


@dataclass(frozen=True, kw_only=True, slots=True)
class SoftObject:
    """A soft object on its lattice."""

    domain: Domain
    """Its cells and nodes in the body frame; its surface points are the held ones."""
    membrane: Domain
    """The membrane's, with the mass that springs between two bodies ask for."""
    young_MPa: float
    """Young's modulus of the object."""
    origin_mm: np.ndarray
    """Origin of the body at the start [mm], sensor frame, shape (3,)."""
    rotation: np.ndarray
    """Rotation body to sensor at the start, shape (3, 3)."""
    cell_map: np.ndarray
    """Cell at each lattice place of a box, -1 for none, shape (A, B, C), int32."""
    first_cell: np.ndarray
    """Lattice place of the box's first corner, shape (3,)."""


def make_soft_object(problem: Problem, indenter: Indenter) -> SoftObject:
    """Fill the object with material points on the grid of the contact.

    Raises:
        DesignError: If it has no elastomer or is smaller than a cell.
    """
    if indenter.soft is None:
        raise DesignError("the object is rigid", hint="give indenter.soft", at="indenter.soft")
    grid_mm, collider = problem.domain.grid_mm, problem.collider
    low, high = box_mm(indenter)
    points = fill(lambda places: _distance(collider, places), low, high, grid_mm)
    if not points.count:
        raise DesignError(
            f"the object is smaller than a cell of {grid_mm:g} mm",
            hint="lower contact.grid_mm or raise indenter.size_mm",
            at="contact.grid_mm",
        )
    soft = indenter.soft
    _check_ratio(soft.young_MPa / problem.material.young_MPa)
    material = Elastomer(young_MPa=soft.young_MPa, poisson=soft.poisson, law=problem.material.law)
    level_mm = high[2] - soft.held_share * (high[2] - low[2])
    domain = build_domain(
        _no_mesh(),
        points,
        _held(points, level_mm, BOND_PENALTY * soft.young_MPa * grid_mm),
        material,
        region=Region(centre_mm=np.zeros(3), radius_mm=EVERYTHING_MM),
        inner_moves=False,
    )
    first, cell_map = _cell_map(points)
    origin, rotation = problem.approach.pose(0.0)
    return SoftObject(
        domain=_heavier_skin(domain, points, problem),
        membrane=_heavier_contact(problem.domain),
        young_MPa=soft.young_MPa,
        origin_mm=origin,
        rotation=rotation,
        cell_map=cell_map,
        first_cell=first,
    )


def _check_ratio(ratio: float) -> None:
    """Refuse bodies so different that they do not relax together."""
    if ratio > STIFFEST_RATIO:
        raise DesignError(
            f"the object is {ratio:.0f} times as stiff as the membrane; the limit is "
            f"{STIFFEST_RATIO:g}",
            hint="leave such an object rigid: it gives way by less than 2 % of the depth",
            at="indenter.soft.young_MPa",
        )


def _distance(collider: Collider, places: np.ndarray) -> np.ndarray:
    return collider.distance(places.reshape(-1, 3))[0].reshape(places.shape[:-1])


def _no_mesh() -> MembraneMesh:
    """The object has no skins of its own: what it looks like is read from its lattice."""
    skin = Skin(
        points_mm=np.zeros((0, 3)), faces=np.zeros((0, 3), np.int32), normals=np.zeros((0, 3))
    )
    return MembraneMesh(hexes=None, outer=skin, inner=skin, cavity=skin)


def _held(points: MaterialPoints, level_mm: float, stiffness_N_mm: float) -> SurfacePoints:
    """A held point in each cell above a level."""
    places = points.cells * points.grid_mm
    places = places[places[:, 2] >= min(level_mm, places[:, 2].max())]
    count = len(places)
    return SurfacePoints(
        position_mm=places.astype(np.float64),
        area_mm2=np.full(count, points.grid_mm**2),
        stiffness_N_mm=np.full(count, stiffness_N_mm),
        axis=np.tile([0.0, 0.0, 1.0], (count, 1)),
        sideways=np.ones(count),
        bonded=np.ones(count, bool),
        drive=np.zeros(count, np.int64),
        vertices=np.zeros((count, 3), np.int64),
        shares=np.tile([1.0, 0.0, 0.0], (count, 1)),
    )


def _cell_map(points: MaterialPoints) -> tuple[np.ndarray, np.ndarray]:
    """First corner of the box around the cells, and the number of the cell at each place of it."""
    first = points.cells.min(axis=0).astype(np.int64)
    shape = points.cells.max(axis=0) - first + 1
    cell_map = np.full(tuple(shape), -1, np.int32)
    # `build_domain` numbers cells in the order of x, y, z, which is that of `fill`.
    order = np.lexsort(points.cells.T[::-1])
    cell_map[tuple((points.cells[order] - first).T)] = np.arange(len(order))
    return first, cell_map


def _heavier_skin(domain: Domain, points: MaterialPoints, problem: Problem) -> Domain:
    """The object's domain with the mass that keeps contact springs on its skin stable.

    A cell belongs to the skin if it is cut or lacks a neighbour.
    """
    order = np.lexsort(points.cells.T[::-1])
    cells = points.cells[order].astype(np.int64)
    known = {tuple(cell) for cell in cells.tolist()}
    steps = [tuple(step) for step in np.concatenate([np.eye(3, dtype=int), -np.eye(3, dtype=int)])]
    alone = [
        any((x + dx, y + dy, z + dz) not in known for dx, dy, dz in steps)
        for x, y, z in cells.tolist()
    ]
    skin = np.flatnonzero((points.fractions[order] < 1.0).any(axis=1) | np.array(alone))
    grid_mm = problem.domain.grid_mm
    per_area = problem.settings.penalty * stiffest_MPa(problem.material) / grid_mm
    spring = CONTACT_MARGIN * per_area * grid_mm**2 / EIGENVALUE
    nodes = stencil_nodes(domain.rows[skin])
    shares = np.broadcast_to(point_weights(np.zeros((1, 3))), nodes.shape)
    added = np.bincount(nodes.ravel(), (spring * shares).ravel(), len(domain.masses))
    return dataclasses.replace(domain, masses=domain.masses + added)


def _heavier_contact(membrane: Domain) -> Domain:
    """The membrane's domain with its contact springs counted twice: their other end moves too."""
    owner = np.repeat(membrane.owners, np.diff(membrane.owner_starts))
    touching = ~membrane.points.bonded
    nodes = stencil_nodes(membrane.rows[owner[touching]])
    spring = membrane.points.stiffness_N_mm[touching, None] / EIGENVALUE
    weights = point_weights(membrane.point_local[touching])
    added = np.bincount(nodes.ravel(), (spring * weights).ravel(), len(membrane.masses))
    return dataclasses.replace(membrane, masses=membrane.masses + added)
