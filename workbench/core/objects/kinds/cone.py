"""A cone with its apex toward the skin, full apex angle 90 degrees.

Its base diameter is `size_mm` and its sharp height half of that.
"""

from __future__ import annotations

import numpy as np

from workbench.core.base.errors import DesignError
from workbench.core.objects.kind import Group, Kind, Shape

ROOT_HALF = 0.5**0.5


def numbers(size_mm: float, edge_mm: float) -> np.ndarray:
    """Rim radius, top, edge radius, apex; all but the edge radius of the sharp inner shape.

    Raises:
        DesignError: If it is too small for its edge radius.
    """
    half = 0.5 * size_mm
    apex = -0.5 * half + edge_mm / ROOT_HALF
    top = 0.5 * half - edge_mm
    if top - apex <= 0.0:
        # The inscribed circle of the section, a right isosceles triangle of height size / 2.
        largest = half / (1.0 + 1.0 / ROOT_HALF)
        raise DesignError(
            f"edge radius {edge_mm:g} mm leaves nothing of a cone {size_mm:g} mm wide; "
            f"the limit is {largest:.2f} mm",
            hint="lower indenter.edge_radius_mm or raise indenter.size_mm",
            at="indenter.edge_radius_mm",
        )
    return np.array([top - apex, top, edge_mm, apex, 0.0, 0.0, 0.0, 0.0])


def lowest_mm(size_mm: float, edge_mm: float) -> float:
    """The rounded apex."""
    return edge_mm - float(numbers(size_mm, edge_mm)[3])


def corners_mm(size_mm: float) -> list[tuple[float, float]]:
    """Apex down, full angle 90 degrees: as high as its base is wide in radius."""
    half = 0.5 * size_mm
    return [(0.0, -half / 2), (half, half / 2), (0.0, half / 2)]


KIND = Kind(
    place=15,
    group=Group.OTHER,
    tip=True,
    lowest_mm=lowest_mm,
    shape=Shape.CONE,
    numbers=numbers,
    corners_mm=corners_mm,
)
