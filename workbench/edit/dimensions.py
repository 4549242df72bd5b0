"""The lines of a design's main sizes, for a front that draws them and lets them be dragged."""

from __future__ import annotations

import numpy as np

from designs.dimensions.dimension import Dimension
from designs.family import resolve_shape
from workbench.core.base.records import records
from workbench.core.design.design import SensorDesign

__all__ = ["Dimension", "dimensions", "dragged"]


def dimensions(design: SensorDesign) -> tuple[Dimension, ...]:
    """The lines of a design; none of a family that states none."""
    make = records("designs.dimensions", "DIMENSIONS").get(design.family)
    if make is None:
        return ()
    return make(resolve_shape(design.family, design.shape), design.layers)


def dragged(line: Dimension, eye_mm: np.ndarray, toward_mm: np.ndarray) -> float:
    """Where the mouse is along a line, from its stop on [mm]: the line's place nearest to its ray.

    Args:
        line: What is dragged.
        eye_mm: Where the tab looks from, shape (3,).
        toward_mm: Any other place under the mouse, shape (3,).

    Returns:
        A finite number; 0 where the eye looks along the line.
    """
    ray = toward_mm - eye_mm
    ray = ray / max(float(np.linalg.norm(ray)), 1e-9)
    along, between = line.direction, np.subtract(line.stop_mm, eye_mm)
    slant = float(along @ ray)
    square = 1.0 - slant**2
    # Of the two closest points of two lines, that on the first.
    return 0.0 if square < 1e-6 else float((ray @ between) * slant - along @ between) / square
