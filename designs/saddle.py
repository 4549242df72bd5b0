"""A saddle between two lobes: an elliptic prism under a roof that is a cosine along Y.

The roof z(y) = valley + lobe (1 - cos(pi y / peak)) / 2 is lowest between the lobes and highest at
y = +-peak; the rim where it meets the upright side is rounded. Without the rounding the volume is a
quadrature of z(y) over the ellipse, so a cut that went wrong shows in the volume.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import Any

import numpy as np

from designs import distance
from designs.prisms import CORNER, ellipse_edges, prism
from workbench.core.base.booleans import cut, expect_volume, fillet
from workbench.core.result.marks import Field

ROOF_POINTS = 41
"""Points through which the roof's cosine is drawn: good to 1e-5 of the volume."""
PIECES = 2
"""Pieces of the outline under the roof: with one the kernel's volume is off by 2e-3, with two by
4e-4."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Saddle:
    """Measures of a saddle that stands on z = 0 with a lobe at either end of Y."""

    half_mm: tuple[float, float]
    """Half axes of the ellipse along X and Y [mm]."""
    valley_mm: float
    """Height of the saddle [mm]."""
    lobe_mm: float
    """Height of the lobes above the saddle [mm]."""
    peak_mm: float
    """Distance of the lobes' highest points from the plane between them [mm]."""
    rim_mm: float
    """Radius of the rounded top rim [mm]."""

    def roof_mm(self, y_mm: np.ndarray) -> np.ndarray:
        """Height of the roof over y [mm]."""
        return self.valley_mm + self.lobe_mm / 2 * (1.0 - np.cos(np.pi * y_mm / self.peak_mm))

    def roof_slope(self, y_mm: np.ndarray) -> np.ndarray:
        """Slope dz/dy of the roof."""
        turn = np.pi / self.peak_mm
        return self.lobe_mm / 2 * turn * np.sin(turn * y_mm)

    @property
    def sharp_mm3(self) -> float:
        """Volume before the rim is rounded [mm3]: the roof over the ellipse.

        Gauss quadrature of z(y) 2 a sqrt(1 - y^2 / b^2) over y = b sin t, which is smooth in t.
        """
        half_x, half_y = self.half_mm
        node, weight = np.polynomial.legendre.leggauss(60)
        turn = np.pi / 2 * node
        strip = self.roof_mm(half_y * np.sin(turn)) * 2 * half_x * np.cos(turn)
        return float(weight @ (strip * half_y * np.cos(turn))) * np.pi / 2


def saddle_body(saddle: Saddle) -> Any:
    """The elliptic prism cut by what is above the roof, its rim rounded.

    Raises:
        GeometryError: If its volume is not that of the quadrature, or the rim was not rounded.
    """
    from build123d import Edge, Face, Solid, Vector, Wire

    half_x, half_y = saddle.half_mm
    top_mm = saddle.valley_mm + saddle.lobe_mm + 2.0
    reach, side = half_y + 1.0, -half_x - 2.0
    y = np.linspace(-reach, reach, ROOF_POINTS)
    slope = float(saddle.roof_slope(np.array([reach]))[0])
    roof = Edge.make_spline(
        [(side, *spot) for spot in zip(y.tolist(), saddle.roof_mm(y).tolist(), strict=True)],
        tangents=[(0.0, 1.0, -slope), (0.0, 1.0, slope)],
    )
    corners = [(side, reach, top_mm), (side, -reach, top_mm)]
    ends = [roof.position_at(1), *corners, roof.position_at(0)]
    lines = [Edge.make_line(a, b) for a, b in itertools.pairwise(ends)]
    above = Solid.extrude(Face(Wire([roof, *lines])), Vector(2 * half_x + 4.0, 0, 0))
    block = prism(ellipse_edges(half_x, half_y, pieces=PIECES), top_mm - 1.0)
    body = cut(block, above, what="saddle")
    # The kernel integrates faces with curved borders to some 4e-4 here; the saddle is 20 %.
    expect_volume(body, saddle.sharp_mm3, what="saddle", relative=1e-3)
    edges = [edge for edge in body.edges() if edge.bounding_box().min.Z > saddle.valley_mm / 2]
    length_mm = sum(edge.length for edge in edges)
    right_mm3 = CORNER * saddle.rim_mm**2 * length_mm
    # Over a slope the corner is sharper or blunter than square: by at most these factors here.
    return fillet(
        body, saddle.rim_mm, edges, what="top rim", removes_mm3=(0.3 * right_mm3, 3 * right_mm3)
    )


def saddle_field(saddle: Saddle) -> Field:
    """Signed distance to a saddle, its rim rounded at the angle that roof and side make there."""

    def outer(points_mm: np.ndarray) -> np.ndarray:
        y = points_mm[:, 1]
        slope = saddle.roof_slope(y)
        steep = np.sqrt(1.0 + slope**2)
        above = (points_mm[:, 2] - saddle.roof_mm(y)) / steep
        aside = points_mm[:, :2] / np.square(saddle.half_mm)
        aside /= np.maximum(np.linalg.norm(aside, axis=1, keepdims=True), 1e-9)
        cosine = -aside[:, 1] * slope / steep
        beside = distance.ellipse(points_mm, *saddle.half_mm)
        return distance.rounded_both(beside, above, saddle.rim_mm, cosine)

    return outer
