"""What a front needs to draw its widgets: presets, families and the parameters of a family.

The front may not import `designs`; it asks here.
"""

from __future__ import annotations

from designs.family import Slider, families, family, resolve_shape, sliders
from workbench.project import load_design, presets

__all__ = ["Slider", "choices", "families", "family", "load_design", "resolve_shape", "sliders"]


def choices() -> tuple[str, ...]:
    """Names a designer can start from: presets first, then families."""
    return (*presets(), *(name for name in families() if name not in presets()))
