"""A gel that hardens: the law on one cube, and what it does to a press of a small pad."""

from __future__ import annotations

import dataclasses
import functools

import numpy as np
import pytest

from sim.fem.elements import CORNERS, make_elements
from sim.fem.press import solve_press
from sim.fem.studies.blocks import flat_membrane
from workbench.core.base.errors import Cancelled, DesignError
from workbench.core.base.monitor import silent
from workbench.core.design.design import Elastomer, Law
from workbench.core.press.fem import FemSettings
from workbench.core.press.press import Press
from workbench.core.press.press_case import PressCase
from workbench.core.result.force_field import ForceField
from workbench.twin.gent import MOST_SHARE, hardening, solve_hardening

CASE = PressCase(
    press=Press(target_mm=(0.0, 0.0, 2.0), depth_mm=0.4, frames=2),
    fem=FemSettings(hex_mm=0.9, radius_mm=4.0, halvings=0, error=False),
)


@functools.cache
def neo_hookean() -> ForceField:
    return solve_press(flat_membrane(width_mm=10.0), Elastomer(), CASE)


@functools.cache
def hardened(limit: float) -> ForceField:
    return solve_hardening(flat_membrane(width_mm=10.0), Elastomer(), CASE, silent, limit=limit)


@pytest.mark.parametrize("stretch", [0.6, 1.0, 1.8])
def test_the_modulus_of_a_stretched_cube_is_gents(stretch: float) -> None:
    """I1 = a^2 + 2 / a at constant volume; mu is over that at rest Jm / (Jm - (I1 - 3))."""
    points = 0.5 * CORNERS
    elements = make_elements(points, np.arange(8)[None], shear_MPa=0.05, bulk_MPa=0.5)
    sides = np.array([stretch, stretch**-0.5, stretch**-0.5])
    beyond = stretch**2 + 2.0 / stretch - 3.0
    found = hardening(elements, points * (sides - 1.0), 3.0)
    np.testing.assert_allclose(found, [3.0 / (3.0 - beyond)], rtol=1e-12)


def test_chains_at_their_end_stay_finite() -> None:
    """A cube stretched to five times its length is 1 / (1 - .95) as stiff, not negative."""
    points = 0.5 * CORNERS
    elements = make_elements(points, np.arange(8)[None], shear_MPa=0.05, bulk_MPa=0.5)
    found = hardening(elements, points * (5.0, 0.0, 0.0), 3.0)
    np.testing.assert_allclose(found, [1.0 / (1.0 - MOST_SHARE)])


def test_a_gel_whose_chains_never_end_is_neo_hookean() -> None:
    """Jm of 1e9: the same forces and the same skin as `solve_press`, to its tolerance."""
    plain, found = neo_hookean(), hardened(1e9)
    np.testing.assert_allclose(found.reaction_N, plain.reaction_N, rtol=1e-4, atol=1e-6)
    np.testing.assert_allclose(found.displacement_mm, plain.displacement_mm, atol=1e-4)


def test_hardening_grows_with_depth() -> None:
    """Jm of 1 needs more force than the neo-Hookean gel, and more so the deeper; it balances."""
    plain, found = neo_hookean(), hardened(1.0)
    more = found.normal_N / plain.normal_N - 1.0
    assert 0.005 < more[0] < more[1] < 1.0
    assert found.converged.all() and (found.balance < 1e-4).all()
    assert "Gent" in found.solver


def test_a_linear_gel_is_refused() -> None:
    """There is nothing to harden in Hooke's law."""
    linear = dataclasses.replace(Elastomer(), law=Law.LINEAR)
    with pytest.raises(DesignError, match="linear"):
        solve_hardening(flat_membrane(width_mm=10.0), linear, CASE, silent)


def test_a_press_can_be_stopped() -> None:
    """At once, by its monitor."""

    def stop(fraction: float, note: str = "") -> None:
        raise Cancelled("stopped")

    with pytest.raises(Cancelled):
        solve_hardening(flat_membrane(width_mm=10.0), Elastomer(), CASE, stop)
