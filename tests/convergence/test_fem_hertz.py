"""A ball on a half-space by finite elements against Hertz."""

from __future__ import annotations

import numpy as np
import pytest

from sim.fem.studies import hertz
from sim.fem.studies.blocks import graded
from workbench.core.design.design import Elastomer, Law

MATERIAL = Elastomer(law=Law.LINEAR, friction=0.0)

pytestmark = pytest.mark.slow


def test_graded_steps_end_where_they_should() -> None:
    """1 mm in steps of 0.25, then growing by 1.4, and exactly 24 at the end without a sliver."""
    places = graded(1.0, 0.25, 24.0, 1.4)
    steps = np.diff(places)
    np.testing.assert_allclose(steps[:4], 0.25)
    assert places[-1] == 24.0
    assert (steps[1:] >= 0.5 * steps[:-1]).all()
    np.testing.assert_allclose(steps[5:-1] / steps[4:-2], 1.4)


def test_far_field_is_that_of_hertz() -> None:
    """At the surface, far away, a force sinks a half-space by F (1 - nu^2) / (pi E r)."""
    away_mm = 24.0
    found = hertz.point_load_mm(np.array([[away_mm, 0.0, 0.0]]), MATERIAL)
    force_N = hertz.exact_force_N(MATERIAL)
    modulus = MATERIAL.young_MPa / (1.0 - MATERIAL.poisson**2)
    assert -found[0, 2] == pytest.approx(force_N / (np.pi * modulus * away_mm), rel=1e-12)
    # Towards the load: 2 nu < 1.
    assert found[0, 0] < 0.0


def test_far_field_is_in_equilibrium() -> None:
    """Navier: grad div u + (1 - 2 nu) lap u = 0, by differences of 1e-3 mm; 1e-4 is their error."""
    h, nu = 1e-3, MATERIAL.poisson
    centre = np.array([1.5, -0.7, -2.0])

    def field(offset: np.ndarray) -> np.ndarray:
        return hertz.point_load_mm((centre + offset)[None], MATERIAL)[0]

    unit = h * np.eye(3)
    second = np.zeros((3, 3, 3))
    for i in range(3):
        for j in range(3):
            corners = [
                s * t * field(s * unit[i] + t * unit[j]) for s in (1.0, -1.0) for t in (1.0, -1.0)
            ]
            second[i, j] = sum(corners) / (4.0 * h * h)
    laplacian = np.einsum("iik->k", second)
    gradient_of_divergence = np.einsum("ikk->i", second)
    rest = gradient_of_divergence + (1.0 - 2.0 * nu) * laplacian
    assert np.abs(rest).max() < 1e-4 * np.abs(laplacian).max()


def test_force_and_radius_converge_to_hertz() -> None:
    """4 E sqrt(R d^3) / (3 (1 - nu^2)) and sqrt(R d); 2.5 % and 3 % at four cells in the radius."""
    exact_N = hertz.exact_force_N(MATERIAL)
    coarse, fine = hertz.press_ball(2), hertz.press_ball(4)
    errors = [press.force_N / exact_N - 1.0 for press in (coarse, fine)]
    assert 0.0 < errors[1] < 0.025
    assert errors[1] < 0.4 * errors[0]
    assert fine.moment_radius_mm == pytest.approx(hertz.CONTACT_MM, rel=0.03)
    # The springs keep the planes of symmetry where they are.
    assert fine.off_axis_mm < 1e-3 * hertz.DEPTH_MM


def test_finite_strain_changes_little_at_a_tenth_of_the_radius() -> None:
    """Neo-Hookean, a / R = 0.1: within 1 % of Hooke's law."""
    neo = hertz.press_ball(2, law=Law.NEO_HOOKEAN).force_N
    assert neo == pytest.approx(hertz.press_ball(2).force_N, rel=0.01)
