"""Elastomers of a design file by their neo-Hookean constants, as finite element programs do.

    [material]
    c10_MPa = 0.025        # half the shear modulus
    d1_per_MPa = 4.1379    # two over the bulk modulus

stands for `young_MPa` and `poisson` (`Elastomer.of_constants` has the equations). A design that is
written out again has the latter two.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from workbench.core.base.errors import DesignError, shown
from workbench.core.design.design import Elastomer

CONSTANTS = ("c10_MPa", "d1_per_MPa")
MODULI = ("young_MPa", "poisson")


def with_moduli(material: Any) -> Any:
    """The table of a material with its moduli in place of the two constants, if it has those.

    Raises:
        DesignError: If one constant stands alone or beside a modulus, or is refused.
    """
    if not isinstance(material, Mapping) or not set(CONSTANTS) & set(material):
        return material
    for name in CONSTANTS:
        value = material.get(name)
        if isinstance(value, bool) or not isinstance(value, (int, float)):
            raise DesignError(
                f"material.{name} is {shown(value)}, and C10 and D1 need each other as numbers",
                hint="give both c10_MPa and d1_per_MPa, or young_MPa and poisson",
                at=f"material.{name}",
            )
    for name in MODULI:
        if name in material:
            raise DesignError(
                f"material.{name} stands beside c10_MPa and d1_per_MPa, which say the same",
                hint=f"leave {name} out, or the two constants",
                at=f"material.{name}",
            )
    c10_MPa, d1_per_MPa = (float(material[name]) for name in CONSTANTS)
    solid = Elastomer.of_constants(c10_MPa=c10_MPa, d1_per_MPa=d1_per_MPa)
    others = {name: value for name, value in material.items() if name not in CONSTANTS}
    return {**others, **{name: getattr(solid, name) for name in MODULI}}
