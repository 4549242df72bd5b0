"""Hardness and modulus say the same in both directions."""

from __future__ import annotations

import pytest

from geometry.silicones import gent_MPa, shore_a


@pytest.mark.parametrize("shore", [0.0, 10.0, 43.0, 90.0])
def test_hardness_and_modulus_are_inverse(shore: float) -> None:
    """shore_a(gent_MPa(S)) = S, exactly."""
    assert shore_a(gent_MPa(shore)) == pytest.approx(shore, abs=1e-9)


def test_the_geltips_silicone_is_softer_than_shore_a() -> None:
    """0.145 MPa lies below 0; the scale begins at .0981 * 56 / (.137505 * 254) = .1573 MPa."""
    assert gent_MPa(0.0) == pytest.approx(0.1573, abs=1e-4)
    assert shore_a(0.145) < 0.0
