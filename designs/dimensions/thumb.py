"""Sizes of a thumb: width, depth and wall at the base, length and tip at the left."""

from __future__ import annotations

from designs.dimensions.dimension import LEFT, Dimension, across, upright, wall_at_base
from designs.thumb import ThumbShape
from workbench.core.design.design import Layers


def thumb_dimensions(shape: ThumbShape, layers: Layers) -> tuple[Dimension, ...]:
    """Width, depth, length, tip height, wall."""
    digit = shape.digit(0.0)
    half, length_mm = digit.half_mm, shape.length_mm
    apex_y, top_mm = float(digit.rows[2, 2, 1]), digit.top_mm
    root_y = float(digit.rows[2, 0, 1])
    side = (half[0], LEFT[1] * half[1])
    root = (digit.root_mm[0], root_y, length_mm)
    return (
        across("shape.width_mm", half, 0),
        across("shape.depth_mm", half, 1),
        upright("shape.length_mm", (0.0, length_mm), side, feet_mm=((half[0], 0.0, 0.0), root)),
        upright("shape.tip_mm", (length_mm, top_mm), side, feet_mm=(root, (0.0, apex_y, top_mm))),
        wall_at_base(half, layers.elastomer_mm),
    )


DIMENSIONS = thumb_dimensions
