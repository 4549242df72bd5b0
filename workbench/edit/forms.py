"""What a front needs to draw its widgets: presets, families and the parameters of a family.

The front may not import `designs` or `geometry`; it asks here.
"""

from __future__ import annotations

from designs.family import Slider, families, family, resolve_shape, sliders
from workbench.core.base.errors import DesignError, shown
from workbench.core.design.design import SensorDesign
from workbench.core.design.imported import IMPORTED
from workbench.project.named_designs import load_design as any_design
from workbench.project.named_designs import presets

__all__ = [
    "Slider",
    "choices",
    "families",
    "family",
    "gent_MPa",
    "hardness",
    "load_design",
    "moduli_MPa",
    "purpose",
    "resolve_shape",
    "shore_a",
    "silicones",
    "sliders",
]


def choices() -> tuple[str, ...]:
    """Names a designer can start from: presets first, then families that need no file."""
    shipped = presets()
    others = (name for name in families() if name not in shipped and name != IMPORTED)
    return (*shipped, *others)


def load_design(name: str) -> SensorDesign:
    """The design of one of the `choices`.

    Raises:
        DesignError: If it is none: what a page sends must not become the path of a file.
    """
    if name not in choices():
        raise DesignError(f"one cannot start from {shown(name)}", hint="choose from the list")
    return any_design(name)


def purpose(name: str) -> str:
    """One line about what a name of `choices` is."""
    return presets().get(name) or family(name).title


def moduli_MPa() -> dict[str, float]:
    """Young's modulus [MPa] of each silicone of the table."""
    from geometry.body.silicones import SILICONES

    return {name: row.young_MPa for name, row in SILICONES.items()}


def hardness(name: str) -> str:
    """Shore hardness of a silicone of the table, with its scale."""
    from geometry.body.silicones import silicone

    return silicone(name).hardness


def gent_MPa(shore: float) -> float:
    """Young's modulus [MPa] of a Shore A hardness; good to some 30 %."""
    from geometry.body.silicones import gent_MPa

    return gent_MPa(shore)


def shore_a(young_MPa: float) -> float:
    """Shore A hardness of a Young's modulus [MPa]; below 0 where it is softer than the scale."""
    from geometry.body.silicones import shore_a

    return shore_a(young_MPa)


def silicones() -> tuple[str, ...]:
    """Names of the silicones that the casting recipe knows."""
    from geometry.body.silicones import SILICONES

    return tuple(SILICONES)
