"""Hardness and modulus say the same in both directions."""

from __future__ import annotations

import pytest

from geometry.body.silicones import SILICONES, gent_MPa, shore_a

BULLETINS = {
    # name: Shore hardness, psi at 100 % strain, g/cm3, % at break, pot life, cure.
    "Ecoflex 00-10": ("00-10", 8.0, 1.04, 800, "30 min", "4 h"),
    "Ecoflex 00-20": ("00-20", 8.0, 1.07, 845, "30 min", "4 h"),
    "Ecoflex 00-30": ("00-30", 10.0, 1.07, 900, "45 min", "4 h"),
    "Ecoflex 00-50": ("00-50", 12.0, 1.07, 980, "18 min", "3 h"),
    "Dragon Skin 10": ("10A", None, 1.07, 1000, "20 min", "5 h"),
    "Dragon Skin 20": ("20A", None, 1.08, 620, "25 min", "4 h"),
    "Dragon Skin 30": ("30A", None, 1.08, 364, "45 min", "16 h"),
    "Solaris": ("15A", None, 0.99, 290, "240 min", "24 h"),
    "Sylgard 184": ("43A", None, 1.03, 120, "90 min", "48 h"),
}
"""As the makers' bulletins print them."""
YOUNG_MPA = {
    # Worked out by hand: Gent's relation, or 12 / 7 of the stress at 100 %.
    "XP-565 1:15": 0.145,
    "Ecoflex 00-10": 0.0946,
    "Ecoflex 00-20": 0.0946,
    "Ecoflex 00-30": 0.1182,
    "Ecoflex 00-50": 0.1418,
    "Dragon Skin 10": 0.4127,
    "Dragon Skin 20": 0.7319,
    "Dragon Skin 30": 1.1424,
    "Solaris": 0.5629,
    "Sylgard 184": 1.8913,
}
MIXES = {"XP-565 1:15": (1.0, 15.0), "Sylgard 184": (10.0, 1.0)}
"""Parts by mass; all others are mixed one to one."""


@pytest.mark.parametrize("shore", [0.0, 10.0, 43.0, 90.0])
def test_hardness_and_modulus_are_inverse(shore: float) -> None:
    """shore_a(gent_MPa(S)) = S, exactly."""
    assert shore_a(gent_MPa(shore)) == pytest.approx(shore, abs=1e-9)


def test_the_geltips_silicone_is_softer_than_shore_a() -> None:
    """0.145 MPa lies below 0; the scale begins at .0981 * 56 / (.137505 * 254) = .1573 MPa."""
    assert gent_MPa(0.0) == pytest.approx(0.1573, abs=1e-4)
    assert shore_a(0.145) < 0.0


def test_the_table_is_that_of_the_bulletins() -> None:
    """Every number of every row, and no row besides."""
    assert set(SILICONES) == {"XP-565 1:15", *BULLETINS} == set(YOUNG_MPA)
    for name, (hardness, _, density, percent, pot_life, cure) in BULLETINS.items():
        row = SILICONES[name]
        assert (row.hardness, row.density_g_cm3, row.cure) == (hardness, density, cure)
        assert row.elongation == pytest.approx(percent / 100.0)
        assert f"{row.pot_life_min:g} min" == pot_life
    for name, row in SILICONES.items():
        assert row.young_MPa == pytest.approx(YOUNG_MPA[name], abs=6e-5)
        assert (row.parts_a, row.parts_b) == MIXES.get(name, (1.0, 1.0))
