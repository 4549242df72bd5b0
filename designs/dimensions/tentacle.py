"""Sizes of a tentacle: width, depth and wall at its foot, and the radius of its bend."""

from __future__ import annotations

from designs.dimensions.dimension import GAP_MM, Dimension, across, wall_at_base
from designs.tentacle import TentacleShape
from workbench.core.design.design import Layers


def tentacle_dimensions(shape: TentacleShape, layers: Layers) -> tuple[Dimension, ...]:
    """Width, depth, bend radius, wall; the bend's axis lies along X through the base plane."""
    half = shape.width_mm / 2, shape.depth_mm / 2
    x, bend_mm = half[0] + 2 * GAP_MM, shape.bend_radius_mm
    return (
        across("shape.width_mm", half, 0),
        across("shape.depth_mm", half, 1),
        Dimension(
            field="shape.bend_radius_mm",
            start_mm=(x, 0.0, 0.0),
            stop_mm=(x, bend_mm, 0.0),
            feet_mm=((half[0], 0.0, 0.0), (0.0, bend_mm, 0.0)),
        ),
        wall_at_base(half, layers.elastomer_mm),
    )


DIMENSIONS = tentacle_dimensions
