"""Cells halved where the contact is small: what they hold, and the field that they carry."""

from __future__ import annotations

import numpy as np
import pytest

from sim.contact.grid.stencil import gradient_table
from sim.contact.motion.approach import plan_approach
from sim.contact.objects.collider import make_collider
from sim.contact.readout.problem import prepare
from sim.contact.region.domain import Domain, stencil_nodes
from sim.contact.region.halving import locate
from sim.contact.studies.specimens import flat_block
from workbench.core.design.design import Elastomer
from workbench.core.press.indenter import Indenter, IndenterKind
from workbench.core.press.press import ContactSettings, Press

GRID_MM = 0.5
HEIGHT_MM = 2.1
"""The free face lies a fifth of a cell below the border of two."""
GRADIENT = np.array([[0.1, -0.2, 0.05], [0.0, 0.15, 0.1], [0.2, 0.0, -0.1]])


def domain_of(
    kind: str, *, frames: int = 5, aside_mm: float = 0.13, size_mm: float = 6.0
) -> Domain:
    mesh, points = flat_block(width_mm=20.0, height_mm=HEIGHT_MM, grid_mm=GRID_MM)
    collider = make_collider(Indenter(kind=IndenterKind(kind), size_mm=size_mm), grid_mm=GRID_MM)
    target_mm = (aside_mm, 0.2, HEIGHT_MM)
    path = Press(target_mm=target_mm, depth_mm=1.0, frames=frames)
    approach = plan_approach(mesh.outer, collider, path)
    return prepare(mesh, points, Elastomer(), approach, ContactSettings(), radius_mm=8.0)


@pytest.fixture(scope="module")
def cone(taichi_device: str) -> Domain:
    """A cone of 0.45 mm at the apex: cells of three sizes."""
    found = domain_of("cone")
    assert set(np.unique(found.edges_mm)) == {0.125, 0.25, 0.5}
    return found


@pytest.mark.usefixtures("taichi_device")
def test_a_large_contact_leaves_cells_whole() -> None:
    """A ball of 20 mm touches 4 cells across where it first rests, 0.1 mm deep."""
    found = domain_of("sphere", size_mm=40.0)
    assert not len(found.ties.nodes)
    assert (found.edges_mm == GRID_MM).all()


@pytest.mark.usefixtures("taichi_device")
def test_cells_do_not_depend_on_the_number_of_frames() -> None:
    """A ball of 3 mm rests each 0.1 mm of its way in one frame as in ten: halved cells alike."""
    once, often = (domain_of("sphere", frames=frames) for frames in (1, 10))
    assert len(once.ties.nodes)
    np.testing.assert_array_equal(once.edges_mm, often.edges_mm)
    np.testing.assert_array_equal(once.node_mm, often.node_mm)


def test_tied_nodes_carry_any_even_strain(cone: Domain) -> None:
    """u = G x at the free nodes is G x at the tied ones, and G at the points of all cells."""
    exact = cone.node_mm @ GRADIENT.T
    spoilt = exact.copy()
    spoilt[cone.ties.nodes] = 9.0
    found = cone.ties.lead(spoilt)
    np.testing.assert_allclose(found, exact, atol=1e-12)
    nodal = found[stencil_nodes(cone.rows)]
    slopes = np.einsum("anr,pnc->aprc", nodal, gradient_table())
    slopes /= cone.edges_mm[:, None, None, None]
    np.testing.assert_allclose(slopes, np.broadcast_to(GRADIENT, slopes.shape), atol=1e-10)


def test_tied_nodes_hand_on_what_they_carry(cone: Domain) -> None:
    """Forces do the same work before and after, at any displacement; shares sum to 1."""
    random = np.random.default_rng(4)
    forces, moves = random.normal(size=(2, *cone.node_mm.shape))
    moves = cone.ties.lead(moves)
    handed = cone.ties.hand_on(forces)
    handed[cone.ties.nodes] = 0.0
    assert (handed * moves).sum() == pytest.approx((forces * moves).sum(), rel=1e-12)
    sums = np.add.reduceat(cone.ties.shares, cone.ties.starts[:-1])
    np.testing.assert_allclose(sums, 1.0, atol=1e-12)


def test_no_leader_is_tied(cone: Domain) -> None:
    """Where levels follow each other, nodes of the finest follow free ones too."""
    assert not np.isin(cone.ties.leaders, cone.ties.nodes).any()


def test_halved_cells_fill_the_block(cone: Domain) -> None:
    """Their points hold pi r^2 h around the target, as the block does, to one layer of samples."""
    node = stencil_nodes(cone.rows)[:, 13]
    place_mm = cone.node_mm[node]
    inside = np.hypot(place_mm[:, 0], place_mm[:, 1]) < 3.0
    whole = domain_of("sphere", frames=1)
    own_mm = whole.node_mm[stencil_nodes(whole.rows)[:, 13]]
    near = np.hypot(own_mm[:, 0], own_mm[:, 1]) < 3.0
    volumes_mm3 = [cone.volumes_mm3[inside].sum(), whole.volumes_mm3[near].sum()]
    # Cells of different size end at the cylinder in different steps; empty ones count 2 %.
    assert volumes_mm3[0] == pytest.approx(volumes_mm3[1], rel=0.02)


def test_places_are_found_in_the_finest_cell() -> None:
    """Cell 0 of level 0 is halved, and its upper child once more."""
    halved = [np.array([[0, 0, 0]]), np.array([[0, 0, 0]])]
    spot = locate(np.array([[0.1, 0.2, 0.3], [-0.1, 0.2, 0.3], [0.6, 0.0, 0.0]]), halved)
    np.testing.assert_array_equal(spot.level, [2, 1, 0])
    np.testing.assert_array_equal(spot.cell, [[0, 0, 1], [-1, 0, 0], [1, 0, 0]])
    edges, shifts = np.array([[[0.25], [0.5], [1.0]], [[0.5], [0.5], [0.0]]])
    centre = (spot.cell + shifts) * edges
    found = centre + spot.local * edges
    np.testing.assert_allclose(found, [[0.1, 0.2, 0.3], [-0.1, 0.2, 0.3], [0.6, 0.0, 0.0]])
