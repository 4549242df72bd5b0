"""Exact contact with a bonded layer, against its limits and figures printed by others."""

from __future__ import annotations

import math

import pytest

from sim.contact.studies import closed_forms
from workbench.core.design.design import Elastomer

THICK_MM = 1000.0
MATERIAL = Elastomer(poisson=0.4)


def test_ball_on_a_thick_layer_is_hertz() -> None:
    """F = 4 E / (3 (1 - nu^2)) sqrt(R) d^1.5, a = sqrt(R d), <r^2> = 2/5 a^2."""
    contact = closed_forms.press_ball(MATERIAL, radius_mm=1.0, height_mm=THICK_MM, depth_mm=1e-4)
    exact_N = closed_forms.hertz_ball_N(MATERIAL, radius_mm=1.0, depth_mm=1e-4)
    # A ball is not its paraboloid: a^2 / R^2 = 1e-4 of the force.
    assert contact.force_N == pytest.approx(exact_N, rel=3e-4)
    assert contact.radius_mm == pytest.approx(0.01, rel=3e-4)
    assert contact.moment_radius_mm == pytest.approx(0.01, rel=3e-4)


def test_sharp_end_on_a_thick_layer_is_boussinesq() -> None:
    """F = 2 a E d / (1 - nu^2); <r^2> of 1 / sqrt(a^2 - r^2) is 2/3 a^2."""
    contact = closed_forms.press_flat_end(
        MATERIAL, radius_mm=2.0, edge_mm=0.0, height_mm=THICK_MM, depth_mm=0.1
    )
    exact_N = 2.0 * 2.0 * MATERIAL.young_MPa * 0.1 / (1.0 - 0.4**2)
    # The layer adds about 1.3 a / h = 0.3 %.
    assert contact.force_N == pytest.approx(exact_N, rel=4e-3)
    assert contact.moment_radius_mm == pytest.approx(2.0 * math.sqrt(5.0 / 3.0), rel=1e-3)


def test_rounded_end_tends_to_the_sharp_one() -> None:
    """What an edge radius takes of the force, 3.3 % at 0.05 mm, goes to zero with it."""
    rounded_N, sharper_N, sharp_N = (
        closed_forms.press_flat_end(
            MATERIAL, radius_mm=2.0, edge_mm=edge_mm, height_mm=4.0, depth_mm=0.02
        ).force_N
        for edge_mm in (0.05, 0.02, 0.0)
    )
    assert 0.02 < 1.0 - rounded_N / sharp_N < 0.04
    limit_N = sharper_N + (sharper_N - rounded_N) * 0.02 / 0.03
    # The loss is nearly proportional to the radius.
    assert limit_N == pytest.approx(sharp_N, rel=2e-3)


def test_rounded_end_of_no_flat_is_a_ball() -> None:
    """A flat of nearly nothing that goes on into an edge of 2 mm is a ball of R 2 mm."""
    end = closed_forms.press_flat_end(
        MATERIAL, radius_mm=2.0 + 1e-9, edge_mm=2.0, height_mm=3.0, depth_mm=0.1
    )
    ball = closed_forms.press_ball(MATERIAL, radius_mm=2.0, height_mm=3.0, depth_mm=0.1)
    assert end.force_N == pytest.approx(ball.force_N, rel=1e-4)
    assert end.radius_mm == pytest.approx(ball.radius_mm, rel=1e-4)


@pytest.mark.parametrize("poisson", [0.3, 0.45, 0.49])
def test_ball_agrees_with_dimitriadis_where_the_contact_is_narrow(poisson: float) -> None:
    """At chi 0.1 the series is the equation's own expansion: 0.2 %; at 0.6 it is 6 to 12 % low."""
    material = Elastomer(poisson=poisson)

    def low(chi: float) -> float:
        sizes = {"radius_mm": 100.0, "height_mm": 4.0, "depth_mm": (4.0 * chi) ** 2 / 100.0}
        exact_N = closed_forms.press_ball(material, **sizes).force_N
        return 1.0 - closed_forms.dimitriadis_ball_N(material, **sizes) / exact_N

    assert abs(low(0.1)) < 2e-3
    assert 0.05 < low(0.6) < 0.12


def test_ball_tends_to_the_incompressible_layer_of_garcia() -> None:
    """At nu 1/2: bracket 1 + 1.133 x + 1.497 x^2 + 1.469 x^3 + 0.755 x^4.

    Source: Garcia and Garcia, Biophys. J. 114 (2018) 2923: their finite elements, too, find more
    force than Dimitriadis' series, 1.283 x^2 + 0.769 x^3.
    """
    chi = 0.5
    sizes = {"radius_mm": 400.0, "depth_mm": (4.0 * chi) ** 2 / 400.0}
    near, nearer = (
        closed_forms.press_ball(material, height_mm=4.0, **sizes).force_N
        / closed_forms.hertz_ball_N(material, **sizes)
        for material in (Elastomer(poisson=0.485), Elastomer(poisson=0.495))
    )
    bracket = 1 + 1.133 * chi + 1.497 * chi**2 + 1.469 * chi**3 + 0.755 * chi**4
    # 0.495 is the most an elastomer may have; their series ends at the fourth power.
    assert nearer + 0.5 * (nearer - near) == pytest.approx(bracket, rel=0.01)


def test_line_on_a_thick_layer_is_hertz() -> None:
    """F / l = pi E a^2 / (4 R (1 - nu^2)), <x^2> = a^2 / 4."""
    contact = closed_forms.press_line(MATERIAL, radius_mm=5.0, height_mm=200.0, depth_mm=0.01)
    modulus = MATERIAL.young_MPa / (1.0 - 0.4**2)
    exact_N_mm = math.pi * modulus * contact.radius_mm**2 / (4.0 * 5.0)
    assert contact.force_N == pytest.approx(exact_N_mm, rel=1e-3)
    assert contact.moment_radius_mm == pytest.approx(contact.radius_mm, rel=1e-3)


def test_line_on_a_thin_layer_is_winkler() -> None:
    """nu 0, a >> h: columns, F / l = 4/3 a d E / h with a = sqrt(2 R d)."""
    material = Elastomer(poisson=0.0)
    contact = closed_forms.press_line(material, radius_mm=50.0, height_mm=0.2, depth_mm=0.02)
    half_mm = math.sqrt(2.0 * 50.0 * 0.02)
    exact_N_mm = 4.0 / 3.0 * half_mm * 0.02 * material.young_MPa / 0.2
    # Columns end at the edge; a layer rounds it off within h.
    assert contact.force_N == pytest.approx(exact_N_mm, rel=0.01)
    assert contact.radius_mm == pytest.approx(half_mm, rel=0.05)


def test_series_has_the_incompressible_limit() -> None:
    """At nu 0.5 the bracket is 1 + 1.133 chi + 1.283 chi^2 + 0.769 chi^3 - 0.0975 chi^4."""
    material = Elastomer(poisson=0.495, young_MPa=1.0)
    force_N = closed_forms.dimitriadis_ball_N(material, radius_mm=2.0, height_mm=2.0, depth_mm=0.5)
    chi = 0.5
    bracket = 1 + 1.133 * chi + 1.283 * chi**2 + 0.769 * chi**3 - 0.0975 * chi**4
    # 0.495 is 2 % from the limit.
    exact_N = 4 / (3 * 0.75) * 2.0**0.5 * 0.5**1.5 * bracket
    assert force_N == pytest.approx(exact_N, rel=0.02)


def test_a_depth_beyond_the_shape_is_refused() -> None:
    """An edge of 0.001 mm on a punch of 1 mm is passed at once when pressed 0.5 mm deep."""
    with pytest.raises(ValueError, match="lacks"):
        closed_forms.press_flat_end(
            MATERIAL, radius_mm=1.0, edge_mm=0.001, height_mm=5.0, depth_mm=0.5
        )
