"""Sizes of a trunk: width and depth at the base, saddle and lobes at the left, and the wall."""

from __future__ import annotations

from designs.dimensions.dimension import Dimension, across, leftmost, upright, wall_at_base
from designs.trunk import TrunkShape
from workbench.core.design.design import Layers


def trunk_dimensions(shape: TrunkShape, layers: Layers) -> tuple[Dimension, ...]:
    """Width, depth, saddle height, lobe height, wall."""
    half, valley_mm = shape.half_mm(0.0), shape.valley_mm
    top_mm, side = valley_mm + shape.lobe_mm, leftmost(half)
    crest = (0.0, -shape.saddle.peak_mm, top_mm)
    return (
        across("shape.width_mm", half, 0),
        across("shape.depth_mm", half, 1),
        upright("shape.valley_mm", (0.0, valley_mm), side),
        upright("shape.lobe_mm", (valley_mm, top_mm), side, feet_mm=((*side, valley_mm), crest)),
        wall_at_base(half, layers.elastomer_mm),
    )


DIMENSIONS = trunk_dimensions
