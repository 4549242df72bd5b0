"""Hexahedra halved under a contact: hanging nodes, smooth skins, and what a press makes of them."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh

from sim.fem.division import Division, Roots, divide, paired_roots
from sim.fem.elements import evaluate, make_elements
from sim.fem.grading import SmoothSkin
from sim.fem.pieces import PLACES
from sim.fem.studies.blocks import block
from workbench.core.result.results import Skin

MIDDLE = np.array([0.5, 0.5, 1.0])


def cube(count: int, *, crooked: float = 0.02) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A unit cube of count^3 crooked hexahedra: nodes, cells, and eights of them."""
    line = np.linspace(0.0, 1.0, count + 1)
    points, cells = block(line, line, line)
    points = points + np.random.default_rng(0).uniform(-crooked, crooked, points.shape)
    place = np.floor(points[cells].mean(axis=1) * count + 1e-9).astype(int)
    number = np.zeros((count, count, count), dtype=int)
    number[tuple(place.T)] = np.arange(len(cells))
    corners = ((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0))
    eights = [
        number[x::2, y::2, z::2].ravel() for z in (0, 1) for x, y, _ in corners if count % 2 == 0
    ]
    return points, cells, np.array(eights).T


def near_top(level: int, middles: np.ndarray) -> np.ndarray:
    return np.linalg.norm(middles - MIDDLE, axis=1) < (0.6, 0.4, 0.2)[level]


def divided(paired: bool) -> Division:
    points, cells, eights = cube(6)
    if paired:
        return divide(paired_roots(points, cells, eights), near_top, most=3)
    none = np.zeros((0, len(PLACES)), dtype=np.int64)
    return divide(Roots(points_mm=points, corners=cells, lattice=none), near_top, most=2)


@pytest.mark.parametrize("paired", [False, True])
def test_a_linear_displacement_is_in_balance_across_hanging_nodes(paired: bool) -> None:
    """Constant strain: no node inside carries a force, as in a mesh without hanging nodes."""
    found = divided(paired)
    assert found.hangs.any() and len(np.unique(found.levels)) == 3 + int(paired)
    assert not found.hangs[found.cells].any()
    elements = make_elements(found.points_mm, found.corners, shear_MPa=1.0, bulk_MPa=30.0)
    gradient = 0.1 * np.random.default_rng(1).normal(size=(3, 3))
    moved = found.points_mm @ gradient.T
    tied = found.tied(elements)
    forces = np.zeros_like(moved)
    np.add.at(forces, tied.cells.ravel(), evaluate(tied, moved).force_N.reshape(-1, 3))
    inside = (np.abs(found.points_mm - 0.5) < 0.45).all(axis=1)
    assert np.abs(forces).max() > 0.1
    assert np.abs(forces[inside]).max() < 1e-14


@pytest.mark.parametrize("paired", [False, True])
def test_neighbours_differ_by_one_halving_and_fill_the_cube(paired: bool) -> None:
    """Cells that share a node that does not hang are at most one halving apart."""
    found = divided(paired)
    volume = make_elements(found.points_mm, found.corners, shear_MPa=1.0, bulk_MPa=1.0).volume_mm3
    points, cells, _ = cube(6)
    whole = make_elements(points, cells, shear_MPa=1.0, bulk_MPa=1.0).volume_mm3.sum()
    # Nodes that hang were moved to the middle, on the cube's crooked outside too.
    assert volume.sum() == pytest.approx(whole, rel=0.02)
    finest = np.zeros(len(found.points_mm), dtype=int)
    coarsest = np.full(len(found.points_mm), 99)
    levels = np.repeat(found.levels, 8)
    np.maximum.at(finest, found.corners.ravel(), levels)
    np.minimum.at(coarsest, found.corners.ravel(), levels)
    used = coarsest < 99
    assert (finest - coarsest)[used].max() == 1


def test_fields_follow_and_sums_are_kept() -> None:
    """A linear field is found again at nodes that hang; shares of every node sum to one."""
    found = divided(paired=True)
    field = found.points_mm @ np.array([1.0, 2.0, -0.5])
    lost = np.where(found.hangs, 0.0, field)
    np.testing.assert_allclose(found.followed(lost), field, atol=1e-12)
    np.testing.assert_allclose(np.asarray(found.shares.sum(axis=1)).ravel(), 1.0, atol=1e-12)


def test_numbers_are_inherited_where_all_agree() -> None:
    points, cells, _ = cube(2, crooked=0.0)
    none = np.zeros((0, len(PLACES)), dtype=np.int64)
    roots = Roots(points_mm=points, corners=cells, lattice=none)
    found = divide(roots, lambda level, middles: np.ones(len(middles), dtype=bool), most=1)
    top = found.inherited((points[:, 2] == 1.0).astype(np.int64), 0) > 0
    np.testing.assert_array_equal(top, found.points_mm[:, 2] == 1.0)


def test_new_nodes_of_a_round_skin_lie_on_it() -> None:
    """On a ball of radius 1: chords of .14 miss it by 2.5e-3, cubics by a hundredth of that."""
    ball = trimesh.creation.icosphere(subdivisions=3)
    points, faces = np.asarray(ball.vertices), np.asarray(ball.faces)
    skin = Skin(points_mm=points, faces=faces.astype(np.int32), normals=points.copy())
    from scipy.sparse import identity

    smooth = SmoothSkin(skin, np.arange(len(points)))
    edges = np.asarray(ball.edges_unique)
    middles = smooth.middles(edges, points, identity(len(points), format="csr"))
    chords = 1.0 - np.linalg.norm(points[edges].mean(axis=1), axis=1)
    missed = np.abs(1.0 - np.linalg.norm(middles, axis=1))
    assert chords.max() > 1e-3
    assert missed.max() < 0.01 * chords.max()


def test_edges_at_a_crease_stay_straight() -> None:
    """A box: its vertices' normals are those of three faces."""
    box = trimesh.creation.box()
    points, faces = np.asarray(box.vertices), np.asarray(box.faces)
    skin = Skin(points_mm=points, faces=faces.astype(np.int32), normals=points / np.sqrt(3.0) * 2.0)
    from scipy.sparse import identity

    edges = np.asarray(box.edges_unique)
    found = SmoothSkin(skin, np.arange(len(points))).middles(
        edges, points, identity(len(points), format="csr")
    )
    np.testing.assert_array_equal(found, points[edges].mean(axis=1))
