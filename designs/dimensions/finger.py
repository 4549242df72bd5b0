"""Sizes of a finger: radius over the tip, straight length and tip at the left, wall at the apex."""

from __future__ import annotations

from designs.dimensions.dimension import ELASTOMER, GAP_MM, LEFT, Dimension, upright
from designs.finger import FingerShape
from workbench.core.design.design import Layers


def finger_dimensions(shape: FingerShape, layers: Layers) -> tuple[Dimension, ...]:
    """Radius, straight length, tip ratio, wall."""
    radius_mm, straight_mm = shape.outer_radius_mm, shape.cylinder_mm
    top_mm = straight_mm + shape.tip_mm
    side = (LEFT[0] * radius_mm, LEFT[1] * radius_mm)
    apex, shoulder = (0.0, 0.0, top_mm), (*side, straight_mm)
    inner_mm = top_mm - layers.elastomer_mm
    return (
        Dimension(
            field="shape.outer_radius_mm",
            start_mm=(0.0, 0.0, top_mm + GAP_MM),
            stop_mm=(*side, top_mm + GAP_MM),
            feet_mm=(apex, shoulder),
        ),
        upright("shape.cylinder_mm", (0.0, straight_mm), side),
        upright(
            "shape.tip_ratio",
            (straight_mm, top_mm),
            side,
            feet_mm=(shoulder, apex),
            per_mm=1.0 / radius_mm,
        ),
        upright(ELASTOMER, (top_mm, inner_mm), side, feet_mm=(apex, (0.0, 0.0, inner_mm)), rows=2),
    )


DIMENSIONS = finger_dimensions
