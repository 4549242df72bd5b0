"""Hexahedra with mean dilatation: patch test, derivatives, Hooke's law, what turning does."""

from __future__ import annotations

import numpy as np
import pytest

from sim.contact.motion.path import turn
from sim.fem.elements import Elements, evaluate, make_elements
from sim.fem.studies.blocks import block, irregular_block
from sim.fem.studies.patch import STRETCH, solve_patch
from sim.material import elastic_solid, first_piola
from workbench.core.base.errors import MeshingError
from workbench.core.design.design import Elastomer, Law

LAWS = pytest.mark.parametrize("law", Law)
SOLID = elastic_solid(Elastomer())


def irregular(law: Law = Law.NEO_HOOKEAN) -> tuple[np.ndarray, Elements]:
    points_mm, cells = irregular_block()
    elements = make_elements(
        points_mm,
        cells,
        shear_MPa=SOLID.shear_MPa,
        bulk_MPa=SOLID.bulk_MPa,
        linear=law is Law.LINEAR,
    )
    return points_mm, elements


def random_motion(scale_mm: float, seed: int = 0) -> np.ndarray:
    return np.random.default_rng(seed).normal(0.0, scale_mm, (64, 3))


@LAWS
def test_patch_of_finite_strain_is_exact(law: Law) -> None:
    """u = (F - I) x and the force P N, to machine precision: a few times 2e-16."""
    patch = solve_patch(law=law)
    assert patch.off > 0.01
    assert patch.displacement < 1e-14
    assert patch.force < 1e-14


@LAWS
def test_patch_of_small_strain_is_exact(law: Law) -> None:
    """The same; F - I = 4e-5 is rounded to 2e-16 in F, which leaves 12 digits."""
    patch = solve_patch(1e-4 * STRETCH, law=law)
    assert patch.displacement < 5e-11
    assert patch.force < 5e-11


@LAWS
def test_force_is_the_slope_of_the_energy(law: Law) -> None:
    """dW = f . du, by a central difference: 1e-6 squared and rounding."""
    _, elements = irregular(law)
    at_mm, way_mm = random_motion(0.03), random_motion(1.0, seed=1)
    state, h = evaluate(elements, at_mm), 1e-6
    ahead, behind = (evaluate(elements, at_mm + s * h * way_mm).energy_Nmm for s in (1, -1))
    along = float((state.force_N * way_mm[elements.cells].reshape(-1, 24)).sum())
    assert (ahead - behind) / (2 * h) == pytest.approx(along, rel=1e-6)


@LAWS
def test_tangent_is_the_slope_of_the_force(law: Law) -> None:
    """df = K du element by element, and K is symmetric."""
    _, elements = irregular(law)
    at_mm, way_mm = random_motion(0.03), random_motion(1.0, seed=1)
    tangent, h = evaluate(elements, at_mm, tangent=True).tangent_N_mm, 1e-6
    assert tangent is not None
    ahead, behind = (evaluate(elements, at_mm + s * h * way_mm).force_N for s in (1, -1))
    known = np.einsum("mij,mj->mi", tangent, way_mm[elements.cells].reshape(-1, 24))
    assert np.abs((ahead - behind) / (2 * h) - known).max() < 1e-6 * np.abs(known).max()
    assert np.abs(tangent - tangent.transpose(0, 2, 1)).max() < 1e-15


@LAWS
def test_stiffness_is_the_same_when_the_forces_are_known(law: Law) -> None:
    """Bit by bit, of the leading elements only; the forces are the known ones."""
    _, elements = irregular(law)
    motion = random_motion(0.03)
    whole, known = evaluate(elements, motion, tangent=True), evaluate(elements, motion)
    again = evaluate(elements, motion, tangent=True, leading=7, known=known)
    assert whole.tangent_N_mm is not None and again.tangent_N_mm is not None
    np.testing.assert_array_equal(again.tangent_N_mm, whole.tangent_N_mm[:7])
    assert again.force_N is known.force_N and again.energy_Nmm == known.energy_Nmm
    np.testing.assert_array_equal(again.force_N, whole.force_N)


def test_hooke_stress_of_a_block() -> None:
    """A linear block of 1 mm2 under sigma = 2 mu e + lambda tr(e) I pulls with sigma N."""
    points_mm, cells = irregular_block()
    elements = make_elements(
        points_mm, cells, shear_MPa=SOLID.shear_MPa, bulk_MPa=SOLID.bulk_MPa, linear=True
    )
    forces = evaluate(elements, points_mm @ STRETCH.T).force_N.reshape(-1, 8, 3)
    side_N = forces[points_mm[cells][..., 0] == 1.0].sum(axis=0)
    strain = 0.5 * (STRETCH + STRETCH.T)
    stress = 2 * SOLID.shear_MPa * strain + SOLID.lame_MPa * np.trace(strain) * np.eye(3)
    np.testing.assert_allclose(side_N, stress[0], atol=1e-15)


def test_laws_agree_at_small_strain() -> None:
    """Neo-Hookean and Hooke's forces differ by the square of the strain, 1e-6."""
    motion_mm = random_motion(1e-6)
    soft, stiff = (evaluate(irregular(law)[1], motion_mm).force_N for law in Law)
    assert 0.0 < np.abs(soft - stiff).max() < 3e-5 * np.abs(stiff).max()


def test_rigid_motion_costs_nothing() -> None:
    """Turned by 80 degrees and moved, energy and forces are zero to rounding."""
    points_mm, elements = irregular()
    rotation = turn(np.array([0.6, 0.0, 0.8]), np.radians(80.0))
    state = evaluate(elements, points_mm @ rotation.T + [1.0, 2.0, 3.0] - points_mm)
    assert abs(state.energy_Nmm) < 1e-15
    assert np.abs(state.force_N).max() < 1e-15


def test_forces_turn_with_the_body() -> None:
    """f(R x) = R f(x)."""
    points_mm, elements = irregular()
    rotation, motion_mm = turn(np.array([0.6, 0.0, 0.8]), 1.0), random_motion(0.03)
    turned_mm = (points_mm + motion_mm) @ rotation.T - points_mm
    there = evaluate(elements, turned_mm).force_N.reshape(-1, 8, 3)
    here = evaluate(elements, motion_mm).force_N.reshape(-1, 8, 3)
    np.testing.assert_allclose(there, here @ rotation.T, atol=1e-15)


def test_a_cell_that_is_inverted_has_no_energy() -> None:
    """A corner pushed through the opposite one: energy inf, which no line search accepts."""
    points_mm, cells = block(*[np.array([0.0, 1.0])] * 3)
    elements = make_elements(points_mm, cells, shear_MPa=1.0, bulk_MPa=10.0)
    motion_mm = np.zeros((8, 3))
    motion_mm[7] = -1.5
    assert evaluate(elements, motion_mm).energy_Nmm == np.inf


def test_a_mesh_that_is_inverted_at_rest_is_refused() -> None:
    points_mm, cells = block(*[np.array([0.0, 1.0])] * 3)
    with pytest.raises(MeshingError, match="hexahedron 0 of 1 is inverted"):
        make_elements(points_mm * [1.0, 1.0, -1.0], cells, shear_MPa=1.0, bulk_MPa=1.0)


def test_mean_dilatation_does_not_lock() -> None:
    """Bent without a change of volume, a cell carries no pressure however large K is."""
    points_mm, cells = block(*[np.array([-1.0, 1.0])] * 3)
    x, _, z = points_mm.T
    bent_mm = 1e-3 * np.stack([x * z, np.zeros(8), np.zeros(8)], axis=1)
    energies = [
        evaluate(
            make_elements(points_mm, cells, shear_MPa=1.0, bulk_MPa=bulk, linear=True), bent_mm
        ).energy_Nmm
        for bulk in (1.0, 1e6)
    ]
    # tr(e) = z averages to nothing; plain hexahedra would store K z^2 / 2.
    assert energies[1] == pytest.approx(energies[0], rel=1e-9)


def test_patch_stress_is_the_law() -> None:
    """The law that the patch is compared with is the one of the contact solver."""
    points_mm, elements = irregular()
    forces = evaluate(elements, points_mm @ STRETCH.T).force_N.reshape(-1, 8, 3)
    side_N = forces[points_mm[elements.cells][..., 2] == 1.0].sum(axis=0)
    np.testing.assert_allclose(side_N, first_piola(STRETCH, SOLID)[:, 2], atol=1e-15)
