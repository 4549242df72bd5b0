"""Upright prisms with a rounded top rim, on any smooth outline: cores and bodies of families.

With area A and perimeter P of the outline, height H and rim radius r, the rounding removes the
corner (1 - pi/4) r^2 along the outline moved inward to the corner's centroid, so by Pappus

    volume = A H - (1 - pi/4) r^2 (P - 2 pi c r),   c = (5/6 - pi/4) / (1 - pi/4) = 0.2234.

It holds for any closed outline whose convex bends are wider than r, so a fillet that went wrong
shows in the volume. Leaves out: outlines with corners.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from designs import distance
from workbench.core.base.booleans import expect_volume, fillet

CORNER = 1.0 - math.pi / 4.0
"""Area between a square corner and its rounding, over r^2."""
CENTROID = (5.0 / 6.0 - math.pi / 4.0) / CORNER
"""Distance of that area's centroid from either side of the corner, over r."""


def rounded_prism_mm3(area_mm2: float, perimeter_mm: float, top_mm: float, rim_mm: float) -> float:
    """Volume of a prism on z = 0 with a rounded top rim [mm3]; see the module docstring."""
    lost = CORNER * rim_mm**2 * (perimeter_mm - 2.0 * math.pi * CENTROID * rim_mm)
    return area_mm2 * top_mm - lost


def rim_limits(perimeter_mm: float, rim_mm: float, *, slack: float) -> tuple[float, float]:
    """Least and most volume that a rim fillet may remove [mm3], for `booleans.fillet`."""
    lost = rounded_prism_mm3(0.0, perimeter_mm, 0.0, rim_mm)
    return -lost * (1.0 - slack), -lost * (1.0 + slack)


def prism(outline: Sequence[Any], top_mm: float) -> Any:
    """The prism over edges in the plane z = 0 that close."""
    from build123d import Face, Solid, Vector, Wire

    return Solid.extrude(Face(Wire(outline)), Vector(0, 0, top_mm))


@dataclass(frozen=True, kw_only=True, slots=True)
class Outline:
    """A smooth closed curve in the plane z = 0, with its closed forms."""

    edges: Sequence[Any]
    """build123d edges that close."""
    area_mm2: float
    perimeter_mm: float


def rounded_prism(
    outline: Outline,
    *,
    top_mm: float,
    rim_mm: float,
    what: str,
    relative: float = 1e-3,
) -> Any:
    """A prism on z = 0 with a rounded top rim, checked by its closed form.

    Args:
        outline: What it stands on.
        relative: Tolerance of the volume; fillets of splines are approximated by the kernel.

    Raises:
        GeometryError: If the kernel could not round the rim.
    """
    block = prism(outline.edges, top_mm)
    edges = [edge for edge in block.edges() if edge.bounding_box().min.Z > top_mm - 1e-3]
    least, most = rim_limits(outline.perimeter_mm, rim_mm, slack=0.05)
    body = fillet(block, rim_mm, edges, what=what, removes_mm3=(least, most))
    expected = rounded_prism_mm3(outline.area_mm2, outline.perimeter_mm, top_mm, rim_mm)
    return expect_volume(body, expected, what=what, relative=relative)


def ellipse_area_mm2(half_x_mm: float, half_y_mm: float) -> float:
    """Area of an ellipse [mm2]."""
    return math.pi * half_x_mm * half_y_mm


def ellipse_perimeter_mm(half_x_mm: float, half_y_mm: float) -> float:
    """Perimeter of an ellipse [mm], by the trapezium rule, which converges exponentially."""
    turn = np.linspace(0.0, 2.0 * np.pi, 256, endpoint=False)
    speed = np.hypot(half_x_mm * np.sin(turn), half_y_mm * np.cos(turn))
    return float(speed.mean() * 2.0 * np.pi)


def ellipse_edges(half_x_mm: float, half_y_mm: float, *, pieces: int = 1) -> list[Any]:
    """The ellipse as edges in the plane z = 0.

    Args:
        pieces: More of them where faces on it will be trimmed by curves: the kernel integrates
            each face's area with a fixed number of points.
    """
    from build123d import Edge, Plane

    plane, axes = Plane.XY, (half_x_mm, half_y_mm)
    if half_x_mm < half_y_mm:
        plane = Plane(origin=(0, 0, 0), x_dir=(0, 1, 0), z_dir=(0, 0, 1))
        axes = (half_y_mm, half_x_mm)
    turns = np.linspace(0.0, 360.0, pieces + 1).tolist()
    return [Edge.make_ellipse(*axes, plane, a, b) for a, b in itertools.pairwise(turns)]


@dataclass(frozen=True, kw_only=True, slots=True)
class EllipticPrism:
    """An elliptic prism on z = 0 with a rounded top rim."""

    half_mm: tuple[float, float]
    """Half axes along X and Y [mm]."""
    top_mm: float
    rim_mm: float

    def body(self, *, what: str) -> Any:
        """The prism as a B-rep body.

        Raises:
            GeometryError: If the kernel could not round the rim.
        """
        outline = Outline(
            edges=ellipse_edges(*self.half_mm),
            area_mm2=ellipse_area_mm2(*self.half_mm),
            perimeter_mm=ellipse_perimeter_mm(*self.half_mm),
        )
        return rounded_prism(
            outline,
            top_mm=self.top_mm,
            rim_mm=self.rim_mm,
            what=what,
        )

    def distance(self, points_mm: np.ndarray) -> np.ndarray:
        """Signed distance to the prism [mm], first order, shape (N,)."""
        beside = distance.ellipse(points_mm, *self.half_mm)
        return distance.rounded_both(beside, points_mm[:, 2] - self.top_mm, self.rim_mm)


def elliptic_foot(
    half_mm: tuple[float, float], cavity_mm: float, height_mm: float, lip_mm: float
) -> Any:
    """A foot below z = 0 on an ellipse wider by a lip, with a bore for the camera.

    Args:
        half_mm: Half axes of the skin at the base.
        cavity_mm: Smallest half width of the cavity above the foot.
    """
    from build123d import Pos

    from designs.plates import bored_plate

    half_x, half_y = half_mm[0] + lip_mm, half_mm[1] + lip_mm
    block = prism(ellipse_edges(half_x, half_y), height_mm)
    expect_volume(block, ellipse_area_mm2(half_x, half_y) * height_mm, what="foot")
    return bored_plate(Pos(0, 0, -height_mm) * block, cavity_mm, height_mm)
