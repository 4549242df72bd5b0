"""Sizes of a DigiTac: width, length and skin at the base, the dome at the left."""

from __future__ import annotations

from designs.digitac import DigitacShape
from designs.dimensions.dimension import Dimension, across, upright, wall_at_base
from workbench.core.design.design import Layers


def digitac_dimensions(shape: DigitacShape, layers: Layers) -> tuple[Dimension, ...]:
    """Width, length, dome, skin."""
    half, low_mm = (shape.width_mm / 2, shape.length_mm / 2), shape.wall_mm
    top_mm = low_mm + shape.dome_mm
    begun, _ = shape.loaf(0.0).straight_mm
    feet = ((half[0], begun, low_mm), (0.0, begun, top_mm))
    return (
        across("shape.width_mm", half, 0),
        across("shape.length_mm", half, 1),
        upright("shape.dome_mm", (low_mm, top_mm), (half[0], -half[1]), feet_mm=feet),
        wall_at_base(half, layers.elastomer_mm),
    )


DIMENSIONS = digitac_dimensions
