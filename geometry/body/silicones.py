"""The silicones a designer can pour: a small table, each row from its maker's bulletin.

Young's modulus follows from Shore A hardness S by E = 0.0981 (56 + 7.62336 S) / (0.137505
(254 - 2.54 S)) MPa. Source: Gent, Rubber Chemistry and Technology 31, 1958. Shore 00 has no such
relation; there E follows from the bulletin's stress at 100 % strain, sigma = E / 3 (l - 1 / l^2)
with l = 2 (neo-Hookean, incompressible), so E = 1.714 sigma. Both are good to some 30 %.

What a bulletin does not state, or we could not confirm, is None.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

from workbench.core.base.errors import DesignError, shown

PSI_MPA = 6.894757e-3
"""Megapascal in a pound per square inch. Source: NIST SP 811."""
NEAR = 0.3
"""Relative difference of moduli that is still the same silicone: the relation's own error."""
UNKNOWN_ELONGATION = 2.0
"""Strain at break assumed where none is known: less than that of every soft silicone here [1]."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Silicone:
    """One row of the table."""

    name: str
    hardness: str
    """Shore hardness with its scale."""
    young_MPa: float
    density_g_cm3: float | None
    parts_a: float
    """Mass of part A for `parts_b` of part B."""
    parts_b: float
    elongation: float | None
    """Strain at break [1]."""
    pot_life_min: float | None
    cure: str
    """How long until demoulding at room temperature."""
    source: str


def gent_MPa(shore_a: float) -> float:
    """Young's modulus [MPa] of a rubber of this Shore A hardness.

    Source: Gent, On the relation between indentation hardness and Young's modulus, 1958.
    """
    return 0.0981 * (56.0 + 7.62336 * shore_a) / (0.137505 * (254.0 - 2.54 * shore_a))


def shore_a(young_MPa: float) -> float:
    """Shore A hardness of a rubber of this Young's modulus [MPa]: the inverse of `gent_MPa`.

    Below 0 where the rubber is softer than the scale reaches; the scale ends at 100.
    """
    scaled = 0.137505 * young_MPa / 0.0981
    return (254.0 * scaled - 56.0) / (7.62336 + 2.54 * scaled)


def doubled_MPa(stress_psi: float) -> float:
    """Young's modulus [MPa] of a neo-Hookean rubber from its nominal stress at 100 % strain [psi].

    sigma = E / 3 (2 - 1 / 4), so E = 12 / 7 sigma.
    """
    return 12.0 / 7.0 * stress_psi * PSI_MPA


class _SmoothOn(NamedTuple):
    """A row of a technical bulletin of Smooth-On; its parts are mixed one to one."""

    name: str
    hardness: str
    young_MPa: float
    density_g_cm3: float
    elongation: float
    pot_life_min: float
    cure: str
    bulletin: str

    @property
    def silicone(self) -> Silicone:
        """The row with its source: the modulus follows from Shore A, else from 100 % strain."""
        how = "Gent 1958" if self.hardness.endswith("A") else "100 % modulus, neo-Hookean"
        return Silicone(
            name=self.name,
            hardness=self.hardness,
            young_MPa=self.young_MPa,
            density_g_cm3=self.density_g_cm3,
            parts_a=1.0,
            parts_b=1.0,
            elongation=self.elongation,
            pot_life_min=self.pot_life_min,
            cure=self.cure,
            source=f"Smooth-On technical bulletin {self.bulletin}; E by {how}",
        )


_SMOOTH_ON = (
    _SmoothOn(
        "Ecoflex 00-10", "00-10", doubled_MPa(8.0), 1.04, 8.00, 30.0, "4 h", "Ecoflex Series"
    ),
    _SmoothOn(
        "Ecoflex 00-20", "00-20", doubled_MPa(8.0), 1.07, 8.45, 30.0, "4 h", "Ecoflex Series"
    ),
    _SmoothOn(
        "Ecoflex 00-30", "00-30", doubled_MPa(10.0), 1.07, 9.00, 45.0, "4 h", "Ecoflex Series"
    ),
    _SmoothOn(
        "Ecoflex 00-50", "00-50", doubled_MPa(12.0), 1.07, 9.80, 18.0, "3 h", "Ecoflex Series"
    ),
    _SmoothOn(
        "Dragon Skin 10", "10A", gent_MPa(10.0), 1.07, 10.00, 20.0, "5 h", "Dragon Skin Series"
    ),
    _SmoothOn(
        "Dragon Skin 20", "20A", gent_MPa(20.0), 1.08, 6.20, 25.0, "4 h", "Dragon Skin Series"
    ),
    _SmoothOn(
        "Dragon Skin 30", "30A", gent_MPa(30.0), 1.08, 3.64, 45.0, "16 h", "Dragon Skin Series"
    ),
    _SmoothOn("Solaris", "15A", gent_MPa(15.0), 0.99, 2.90, 240.0, "24 h", "Solaris"),
)
"""Numbers of the maker's technical bulletins."""
_ROWS = (
    Silicone(
        name="XP-565 1:15",
        hardness="below Shore A scale",
        young_MPa=0.145,
        density_g_cm3=None,
        parts_a=1.0,
        parts_b=15.0,
        elongation=None,
        pot_life_min=None,
        cure="follow the maker's sheet",
        source="Silicones Inc. XP-565 mixed 1:15; E from SimTac, Supplementary (1.45e5 Pa)",
    ),
    *(sheet.silicone for sheet in _SMOOTH_ON),
    Silicone(
        name="Sylgard 184",
        hardness="43A",
        young_MPa=gent_MPa(43.0),
        density_g_cm3=1.03,
        parts_a=10.0,
        parts_b=1.0,
        elongation=1.2,
        pot_life_min=90.0,
        cure="48 h",
        source="Dow, SYLGARD 184 Silicone Elastomer technical data sheet; E by Gent 1958",
    ),
)
SILICONES = {row.name: row for row in _ROWS}


def silicone(name: str) -> Silicone:
    """The silicone of that name.

    Raises:
        DesignError: If it is not in the table.
    """
    if name not in SILICONES:
        raise DesignError(
            f"there is no silicone {shown(name)} in the table",
            hint=f"choose one of: {', '.join(SILICONES)}",
            at="casting.silicone",
        )
    return SILICONES[name]


def elongation(name: str) -> float:
    """Strain at break [1] of a silicone; 2 where the table does not know it."""
    known = silicone(name).elongation
    return UNKNOWN_ELONGATION if known is None else known


def nearest(young_MPa: float) -> Silicone:
    """The silicone whose modulus is nearest by ratio."""
    return min(_ROWS, key=lambda row: max(row.young_MPa / young_MPa, young_MPa / row.young_MPa))
