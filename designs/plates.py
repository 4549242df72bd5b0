"""Flat-sided pieces that several families stand on: rounded prisms and bored feet."""

from __future__ import annotations

from typing import Any

import numpy as np

from workbench.core.base.booleans import cut, expect_volume

BORE_SHARE = 0.6
"""Radius of the camera bore over the cavity's smallest half width."""


def rounded_prism(
    width_mm: float, depth_mm: float, corner_mm: float, from_mm: float, to_mm: float
) -> Any:
    """An upright prism on a rounded rectangle about the axis, between two heights.

    Raises:
        GeometryError: If its volume is not that of the closed form.
    """
    from build123d import Pos, RectangleRounded, extrude

    height_mm = to_mm - from_mm
    outline = RectangleRounded(width_mm, depth_mm, corner_mm)
    body = Pos(0, 0, from_mm) * extrude(outline, amount=height_mm)
    area_mm2 = width_mm * depth_mm - (4 - np.pi) * corner_mm**2
    return expect_volume(body, area_mm2 * height_mm, what="prism")


def bored_plate(plate: Any, cavity_mm: float, height_mm: float) -> Any:
    """A foot below z = 0 with a bore for the camera along the axis.

    Args:
        plate: The foot without its bore.
        cavity_mm: Smallest half width of the cavity above it.
        height_mm: Height of the foot.
    """
    from build123d import Cylinder, Pos

    bore = Pos(0, 0, -height_mm / 2) * Cylinder(BORE_SHARE * cavity_mm, height_mm)
    return cut(plate, bore, what="camera bore from the foot")


def rectangle_distance(
    points_mm: np.ndarray, half_x_mm: float, half_y_mm: float, corner_mm: float
) -> np.ndarray:
    """Signed distance to a rounded rectangle [mm], shape (N,); points (N, 2). Exact.

    Source: Quilez, 2D distance functions.
    """
    corner = np.array([half_x_mm, half_y_mm]) - corner_mm
    over = np.abs(points_mm) - corner
    outside = np.linalg.norm(np.maximum(over, 0.0), axis=1)
    return outside + np.minimum(over.max(axis=1), 0.0) - corner_mm
