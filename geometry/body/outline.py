"""Half the outline of a body of revolution: an upright side, then a quarter of an ellipse."""

from __future__ import annotations

import math
from typing import Any

QUARTER = math.sqrt(0.5)
"""Weight of the middle control point of a quarter circle."""
CIRCLE_MM = 1e-9
"""Difference of the half axes below which the dome is a part of a sphere [mm]."""


def upright_and_dome(radius_mm: float, upright_mm: float, dome_mm: float) -> list[Any]:
    """Edges in the plane y = 0, from (radius, 0, 0) up to the apex (0, 0, upright + dome)."""
    from build123d import Edge, Plane

    shoulder, apex = (radius_mm, 0.0, upright_mm), (0.0, 0.0, upright_mm + dome_mm)
    side = Edge.make_line((radius_mm, 0.0, 0.0), shoulder)
    # A circle gives a true sphere, which the kernel tessellates twice as fast as an ellipsoid.
    if abs(radius_mm - dome_mm) < CIRCLE_MM:
        section = Plane(origin=(0, 0, upright_mm), x_dir=(1, 0, 0), z_dir=(0, -1, 0))
        return [side, Edge.make_circle(radius_mm, section, 0.0, 90.0)]
    # A rational Bezier curve holds the quarter exactly. Revolved as an ellipse, it comes back from
    # a STEP file with its axes exchanged, and the volume is another one.
    corner = (radius_mm, 0.0, upright_mm + dome_mm)
    return [side, Edge.make_bezier(shoulder, corner, apex, weights=[1.0, QUARTER, 1.0])]
