"""The neo-Hookean solid against its textbook form."""

import numpy as np
import pytest

from sim.material import elastic_solid, first_piola
from workbench.core.design.design import Elastomer


def random_gradients(scale: float) -> np.ndarray:
    return scale * np.random.default_rng(1).uniform(-1.0, 1.0, (50, 3, 3))


def test_constants_are_those_of_the_paper() -> None:
    """E 0.145 MPa and nu 0.45 are C10 = 0.025 MPa and D1 = 4.1379 / MPa."""
    solid = elastic_solid(Elastomer())
    assert solid.c10_MPa == pytest.approx(0.025)
    assert solid.d1_per_MPa == pytest.approx(4.1379, abs=1e-4)


def test_stress_is_the_textbook_formula() -> None:
    """P = mu J^(-2/3) (F - tr(F^T F) / 3 F^-T) + K (J - 1) J F^-T, to rounding."""
    solid, gradient = elastic_solid(Elastomer()), random_gradients(0.3)
    deformation = gradient + np.eye(3)
    ratio = np.linalg.det(deformation)[:, None, None]
    inverse = np.linalg.inv(deformation).transpose(0, 2, 1)
    square = (deformation**2).sum(axis=(1, 2))[:, None, None]
    exact = solid.shear_MPa * ratio ** (-2 / 3) * (deformation - square / 3 * inverse)
    exact += solid.bulk_MPa * (ratio - 1) * ratio * inverse
    np.testing.assert_allclose(first_piola(gradient, solid), exact, atol=1e-14)


def test_small_strain_is_linear_elasticity() -> None:
    """P = lambda tr(e) I + 2 mu e; the next order is the strain squared, 1e-12."""
    solid, gradient = elastic_solid(Elastomer()), random_gradients(1e-6)
    strain = 0.5 * (gradient + gradient.transpose(0, 2, 1))
    trace = np.trace(strain, axis1=1, axis2=2)[:, None, None]
    exact = solid.lame_MPa * trace * np.eye(3) + 2 * solid.shear_MPa * strain
    np.testing.assert_allclose(first_piola(gradient, solid), exact, atol=1e-11)


def test_rotation_gives_no_stress() -> None:
    """A rigid rotation by 30 degrees has P = 0."""
    cosine, sine = np.cos(np.pi / 6), np.sin(np.pi / 6)
    rotation = np.array([[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]])
    stress = first_piola((rotation - np.eye(3))[None], elastic_solid(Elastomer()))
    assert np.abs(stress).max() < 1e-15
