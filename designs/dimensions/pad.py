"""Sizes of a pad: width and depth at the base, standoff and gel at its left corner."""

from __future__ import annotations

from designs.dimensions.dimension import ELASTOMER, Dimension, across, upright
from designs.pad import PadShape
from workbench.core.design.design import Layers


def pad_dimensions(shape: PadShape, layers: Layers) -> tuple[Dimension, ...]:
    """Width, depth, standoff, gel at the upright edges."""
    half = shape.width_mm / 2, shape.depth_mm / 2
    plate_mm, corner = shape.standoff_mm, (half[0], -half[1])
    return (
        across("shape.width_mm", half, 0),
        across("shape.depth_mm", half, 1),
        upright("shape.standoff_mm", (0.0, plate_mm), corner),
        upright(ELASTOMER, (plate_mm, plate_mm + layers.elastomer_mm), corner),
    )


DIMENSIONS = pad_dimensions
