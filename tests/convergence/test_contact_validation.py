"""The contact solver against closed forms and finite elements."""

import numpy as np
import pytest

from sim.contact import checks
from workbench.core.design import Elastomer

pytestmark = pytest.mark.usefixtures("taichi_device")


def test_layer_formula_has_the_incompressible_limit() -> None:
    """At nu 0.5 the bracket is 1 + 1.133 chi + 1.283 chi^2 + 0.769 chi^3 - 0.0975 chi^4."""
    material = Elastomer(poisson=0.495, young_MPa=1.0)
    force = checks.bonded_layer_force_N(material, radius_mm=2.0, height_mm=2.0, depth_mm=0.5)
    chi = 0.5
    bracket = 1 + 1.133 * chi + 1.283 * chi**2 + 0.769 * chi**3 - 0.0975 * chi**4
    # 0.495 is as near as the material allows: 2 % from the limit.
    exact = 4 / (3 * 0.75) * 2.0**0.5 * 0.5**1.5 * bracket
    assert force == pytest.approx(exact, rel=0.02)


@pytest.mark.slow
def test_bonded_block_force_within_7_percent() -> None:
    """Dimitriadis' bonded layer at chi 0.27 to 0.35; the contact radius is 3.3 cells or more."""
    assert np.abs(checks.bonded_block_errors(grid_mm=0.4)).max() < 0.07


def test_gel_behind_a_block_is_a_second_column() -> None:
    """F = A d / (h / E + gap / E_gel) = 0.0564, 0.151, 0.243 N for gels of 0.02, 0.1, 1 MPa."""
    for backing_MPa in checks.BACKINGS_MPa:
        exact = checks.two_columns_force_N(backing_MPa)
        # Small strain against 4 % with neo-Hookean columns: 2 %, and the grid 1.5 %.
        assert checks.backed_block_force_N(backing_MPa) == pytest.approx(exact, rel=0.03)


@pytest.mark.slow
def test_gel_behind_a_block_is_sheared_by_a_third_of_its_modulus() -> None:
    """F = A d / (h / G + gap / G_gel) = 2.87e-3 N; with E_gel sideways it would be 7.9e-3 N."""
    backing_MPa = checks.SHEARED_BACKING_MPa
    exact = checks.two_sheared_columns_force_N(backing_MPa)
    assert exact == pytest.approx(36.0 * 0.05 / (2.0 / 0.0725 + 600.0), rel=1e-12)
    # The block bends as well: measured 2.0 % less, and 3.5 % on gel twice as stiff.
    assert checks.backed_block_shear_N(backing_MPa) == pytest.approx(exact, rel=0.03)


@pytest.mark.slow
def test_finger_at_45_degrees_is_that_of_finite_elements() -> None:
    """FEM: 1.424, 1.308, 1.291 N, falling with its mesh; this method rises with its own."""
    coarse = checks.finger_45(grid_mm=0.5, active_radius_mm=9.0)
    assert 1.20 < coarse < 1.35
    finer = checks.finger_45(grid_mm=0.4, active_radius_mm=9.0)
    assert abs(finer - 1.291) < abs(coarse - 1.291) + 0.01
    assert finer == pytest.approx(coarse, rel=0.03)


@pytest.mark.slow
def test_region_of_9_mm_changes_the_force_by_less_than_1_percent() -> None:
    """Spike: 0.23 % against the full membrane."""
    near, far = (checks.finger_45(active_radius_mm=radius_mm) for radius_mm in (9.0, 12.0))
    assert near == pytest.approx(far, rel=0.01)


@pytest.mark.slow
def test_sheared_sphere_drags_like_finite_elements() -> None:
    """1 mm deep, 0.5 mm along V: FEM has a tangential force of 0.267 N."""
    _, along_u, along_v = checks.finger_45_sheared()
    assert along_v == pytest.approx(-0.267, rel=0.05)
    assert abs(along_u) < 0.01


@pytest.mark.slow
def test_default_press_overlaps_little_and_balances() -> None:
    """Ten frames of the default press: overlap below 0.02 cell, support within 1 %."""
    from workbench.core.press import Press

    contact = checks.press_finger(Press())
    overlap, imbalance = checks.penetration_and_balance(contact)
    assert overlap < 0.02
    assert imbalance < 0.01
    assert contact.residual.max() < 1e-3
