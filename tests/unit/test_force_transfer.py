"""Forces carried from one skin to another keep their sum; values keep linear fields."""

from __future__ import annotations

import numpy as np
import pytest

from geometry.surface.surface import vertex_areas_mm2
from sim.forces.shares import barycentric, shares_on
from sim.forces.spreading import spreading
from sim.forces.transfer import transferred
from workbench.core.result.force_field import ForceField, Source
from workbench.core.result.results import MembraneMesh, Skin


def patch(count: int) -> Skin:
    """The unit square at z = 0 in triangles of one `count`-th."""
    side = np.linspace(0.0, 1.0, count + 1)
    x, y = np.meshgrid(side, side, indexing="ij")
    number = np.arange((count + 1) ** 2).reshape(count + 1, count + 1)
    a, b = number[:-1, :-1].ravel(), number[1:, :-1].ravel()
    c, d = number[1:, 1:].ravel(), number[:-1, 1:].ravel()
    faces = np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)]).astype(np.int32)
    points = np.stack([x.ravel(), y.ravel(), np.zeros(x.size)], axis=1)
    return Skin(points_mm=points, faces=faces, normals=np.tile([0.0, 0.0, 1.0], (x.size, 1)))


COARSE, FINE = patch(3), patch(7)


def test_a_linear_field_is_carried_exactly() -> None:
    """u = (x, 2 y, x - y) at the vertices of the one is so at those of the other."""

    def field(points: np.ndarray) -> np.ndarray:
        x, y = points[:, 0], points[:, 1]
        return np.stack([x, 2.0 * y, x - y], axis=1)[None]

    found = shares_on(COARSE, FINE.points_mm).interpolate(field(COARSE.points_mm))
    assert np.allclose(found, field(FINE.points_mm), atol=1e-12)


def test_forces_keep_their_sum_and_their_moment() -> None:
    """Shares of a force at a point of a triangle act, together, where the force did."""
    rng = np.random.default_rng(1)
    forces = rng.normal(size=(2, len(FINE.points_mm), 3))
    spread = shares_on(COARSE, FINE.points_mm).spread(forces, len(COARSE.points_mm))
    assert np.allclose(spread.sum(axis=1), forces.sum(axis=1), atol=1e-5)
    before = np.cross(FINE.points_mm, forces).sum(axis=1)
    after = np.cross(COARSE.points_mm, spread).sum(axis=1)
    assert np.allclose(after, before, atol=1e-5)


def test_flags_are_those_of_the_nearest_vertex() -> None:
    """A flag is not shared out."""
    flags = COARSE.points_mm[None, :, 0] > 0.5
    found = shares_on(COARSE, FINE.points_mm).nearest(flags)
    assert found.dtype == bool
    assert (found[0] == (FINE.points_mm[:, 0] > 0.5)).mean() > 0.95


@pytest.mark.parametrize("share", [(1.0, 0.0, 0.0), (0.2, 0.3, 0.5), (0.0, 0.5, 0.5)])
def test_barycentric_coordinates_are_those_the_point_was_made_of(
    share: tuple[float, float, float],
) -> None:
    """Corner, inside and edge of a triangle in space."""
    corners = np.array([[[0.0, 0.0, 0.0], [2.0, 0.1, 0.3], [0.4, 1.5, -0.2]]])
    point = np.einsum("c,ncx->nx", share, corners)
    assert np.allclose(barycentric(corners, point)[0], share, atol=1e-12)


@pytest.mark.parametrize(("source", "target"), [(COARSE, FINE), (FINE, COARSE)])
def test_spread_forces_keep_their_sum_and_their_moment(source: Skin, target: Skin) -> None:
    """Of any forces the sum to rounding; on an even mesh, away from its rim, the moment too."""
    rng = np.random.default_rng(2)
    forces = rng.normal(size=(2, len(source.points_mm), 3))
    every = np.ones(len(source.points_mm), bool)
    found = spreading(source, target, every).forces(forces)
    assert found.dtype == np.float32
    assert np.allclose(found.sum(axis=1), forces.sum(axis=1), atol=1e-5)
    inner = np.abs(source.points_mm[:, :2] - 0.5).max(axis=1) < 0.49
    forces[:, ~inner] = 0.0
    found = spreading(source, target, inner).forces(forces)
    before = np.cross(source.points_mm, forces).sum(axis=1)
    assert np.allclose(np.cross(target.points_mm, found).sum(axis=1), before, atol=1e-5)


def test_a_uniform_pressure_stays_uniform_on_a_finer_skin() -> None:
    """Every vertex gets its own area's share to 4 %; shared out by vertices some would get none."""
    coarse, fine = patch(10), patch(23)
    areas = [vertex_areas_mm2(skin.points_mm, skin.faces) for skin in (coarse, fine)]
    force = (areas[0][:, None] * [0.0, 0.0, -1.0])[None]
    every = np.ones(len(coarse.points_mm), bool)
    found = spreading(coarse, fine, every).forces(force)[0, :, 2]
    # The error is that of a sum over patches of a third of an edge.
    assert np.allclose(found, -areas[1], rtol=0.04)
    lumps = shares_on(fine, coarse.points_mm).spread(force, len(fine.points_mm))[0, :, 2]
    assert (lumps == 0.0).mean() > 0.4


def test_scalars_are_spread_as_forces_are() -> None:
    """The size of forces along one axis, and nothing where nothing is loaded."""
    size = np.random.default_rng(4).random((2, len(COARSE.points_mm)))
    every = np.ones(len(COARSE.points_mm), bool)
    there = spreading(COARSE, FINE, every)
    found = there.forces(size)
    assert found.shape == (2, len(FINE.points_mm))
    assert np.allclose(found, there.forces(size[..., None] * [0.0, 0.0, 1.0])[..., 2])
    assert not spreading(COARSE, FINE, ~every).forces(size).any()


def test_a_result_presses_on_another_skin_as_much_as_on_its_own() -> None:
    """Sum of forces = minus the reaction to 1e-6; pressure times area keeps its sum as well."""
    meshes = [
        MembraneMesh(hexes=None, outer=skin, inner=skin, cavity=skin) for skin in (COARSE, FINE)
    ]
    areas = [vertex_areas_mm2(skin.points_mm, skin.faces) for skin in (COARSE, FINE)]
    rng = np.random.default_rng(6)
    force = rng.normal(size=(2, len(COARSE.points_mm), 3)).astype(np.float32)
    pressure = rng.random((2, len(COARSE.points_mm)), dtype=np.float32)
    given = ForceField(
        source=Source.FEM,
        displacement_mm=np.zeros_like(force),
        contact_force_N=force,
        reaction_N=-force.sum(axis=1, dtype=np.float64),
        target_mm=np.zeros(3),
        normal=np.array([0.0, 0.0, 1.0]),
        tangent_u=np.array([1.0, 0.0, 0.0]),
        indenter_pose=np.zeros((2, 7)),
        residual=np.zeros(2),
        balance=np.zeros(2),
        converged=np.ones(2, bool),
        pressure_MPa=pressure,
    )
    found = transferred(given, *meshes)
    total_N = found.contact_force_N.sum(axis=1, dtype=np.float64)
    size_N = np.linalg.norm(given.reaction_N, axis=1, keepdims=True)
    assert (np.abs(total_N + found.reaction_N) < 1e-6 * size_N).all()
    assert np.allclose(found.pressure_MPa @ areas[1], pressure @ areas[0], rtol=1e-6)
    assert transferred(given, meshes[0], meshes[0]) is given
