"""Sizes of a paw: its height and that of the toes at the left, and how far out the toes stand."""

from __future__ import annotations

from designs.dimensions.dimension import GAP_MM, Dimension, leftmost, upright
from designs.paw_shape import PawShape
from workbench.core.design.design import Layers


def paw_dimensions(shape: PawShape, layers: Layers) -> tuple[Dimension, ...]:
    """Height, toe height, toe ring.

    The core of a paw is level under toes and heel, so no place of its skin is as thick as
    `layers.elastomer_mm` and can be seen.
    """
    first = shape.toes[0].place_mm
    flat_mm, top_mm = shape.height_mm, shape.height_mm + shape.toe_pad_mm
    bead = (*first, top_mm)
    lobe = shape.toe_lobe_mm
    reach_mm = shape.toe_ring_mm + max(lobe)
    side = leftmost((reach_mm, reach_mm))
    return (
        upright("shape.height_mm", (0.0, flat_mm), side),
        upright("shape.toe_pad_mm", (flat_mm, top_mm), side, feet_mm=((*side, flat_mm), bead)),
        Dimension(
            field="shape.toe_ring_mm",
            start_mm=(0.0, 0.0, top_mm + GAP_MM),
            stop_mm=(*first, top_mm + GAP_MM),
            feet_mm=((0.0, 0.0, flat_mm), bead),
        ),
    )


DIMENSIONS = paw_dimensions
