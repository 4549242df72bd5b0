"""What a front needs to draw its widgets: presets, families and the parameters of a family.

The front may not import `designs` or `geometry`; it asks here.
"""

from __future__ import annotations

from designs.family import Slider, families, family, resolve_shape, sliders
from workbench.bodies import IMPORTED
from workbench.project import load_design, presets

__all__ = [
    "Slider",
    "choices",
    "families",
    "family",
    "load_design",
    "purpose",
    "resolve_shape",
    "silicones",
    "sliders",
]


def choices() -> tuple[str, ...]:
    """Names a designer can start from: presets first, then families that need no file."""
    shipped = presets()
    others = (name for name in families() if name not in shipped and name != IMPORTED)
    return (*shipped, *others)


def purpose(name: str) -> str:
    """One line about what a name of `choices` is."""
    return presets().get(name) or family(name).title


def silicones() -> tuple[str, ...]:
    """Names of the silicones that the casting recipe knows."""
    from geometry.silicones import SILICONES

    return tuple(SILICONES)
