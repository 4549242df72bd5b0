"""A bent, tapered column with a rounded tip, exact as a B-rep and as a signed distance.

Every horizontal section is an ellipse. With u = z / L on the straight-to-bent part of length L,

    half axes  a(u) = a0 - (a0 - a1) (2 u - u^2),   b likewise,     (level at u = 1)
    centre     c(u) = (bend_x, bend_y) u^2,                          (upright at u = 0)

and above it half an ellipsoid of height h, sheared by the slope of the centre line, so that side
and tip share a tangent. All of it is rational quadratic, so Bezier patches hold it exactly and

    volume = integral of pi a b dz + 2/3 pi a1 b1 h     (Cavalieri: shear does not matter).

A smaller column inside (half axes and tip less by an inset) leaves a wall that is even level by
level; measured along the normal it is thinner by the cosine of the slope. Leaves out: twist.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from designs.outline import QUARTER
from designs.shells import sewn
from workbench.core.base.booleans import expect_volume
from workbench.core.result.marks import Field

APEX_MM = 1e-9


@dataclass(frozen=True, kw_only=True, slots=True)
class Column:
    """A bent, tapered column on z = 0."""

    foot_mm: tuple[float, float]
    """Half axes along X and Y at the base [mm]."""
    head_mm: tuple[float, float]
    """Half axes where the tip begins [mm]."""
    length_mm: float
    """Height at which the tip begins [mm]."""
    tip_mm: float
    """Height of the tip above that [mm]."""
    bend_mm: tuple[float, float] = (0.0, 0.0)
    """Where the centre line has moved to at `length_mm` [mm]."""

    def inset(self, wall_mm: float) -> Column:
        """The column smaller by a wall on all sides."""
        return Column(
            foot_mm=(self.foot_mm[0] - wall_mm, self.foot_mm[1] - wall_mm),
            head_mm=(self.head_mm[0] - wall_mm, self.head_mm[1] - wall_mm),
            length_mm=self.length_mm,
            tip_mm=self.tip_mm - wall_mm,
            bend_mm=self.bend_mm,
        )

    @property
    def least_mm(self) -> float:
        """Smallest half axis or tip height [mm]: a wall must be thinner."""
        return min(*self.foot_mm, *self.head_mm, self.tip_mm)

    @property
    def volume_mm3(self) -> float:
        """Closed form of the module docstring [mm3]; the integral is Gauss's, exact here."""
        node, weight = np.polynomial.legendre.leggauss(4)
        axes = self.half_axes(self.length_mm * (node + 1.0) / 2.0)
        side = math.pi * float(weight @ (axes[:, 0] * axes[:, 1])) * self.length_mm / 2.0
        return side + 2.0 / 3.0 * math.pi * self.head_mm[0] * self.head_mm[1] * self.tip_mm

    def half_axes(self, z_mm: np.ndarray) -> np.ndarray:
        """Half axes of the sections below the tip [mm], shape (N, 2)."""
        u = np.clip(z_mm / self.length_mm, 0.0, 1.0)[:, None]
        foot, head = np.array(self.foot_mm), np.array(self.head_mm)
        return foot - (foot - head) * (2.0 * u - u * u)

    def centres(self, z_mm: np.ndarray) -> np.ndarray:
        """Centre line [mm], shape (N, 2); straight on within the tip."""
        u = z_mm[:, None] / self.length_mm
        return np.array(self.bend_mm) * np.where(u < 1.0, u * u, 2.0 * u - 1.0)

    def box_mm(self) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
        """Corners of the box around it [mm], by the extremes of its sections."""
        share = np.concatenate([np.zeros(64), 1.0 - np.cos(np.linspace(0, math.pi / 2, 65))])
        share[:64] = np.linspace(0.0, 1.0, 64, endpoint=False)
        above = np.concatenate([np.zeros(64), np.sin(np.linspace(0, math.pi / 2, 65))])
        z = np.where(np.arange(129) < 64, share * self.length_mm, 0.0)
        z[64:] = self.length_mm + above[64:] * self.tip_mm
        width = self.half_axes(z) * np.sqrt(1.0 - above[:, None] ** 2)
        low = (self.centres(z) - width).min(axis=0)
        high = (self.centres(z) + width).max(axis=0)
        return (*low.tolist(), 0.0), (*high.tolist(), self.length_mm + self.tip_mm)  # pyright: ignore[reportReturnType]


def column_field(column: Column) -> Field:
    """Signed distance to a column, first order: its norm's excess over the slope of the norm.

    norm^2 = ((x - cx) / a)^2 + ((y - cy) / b)^2 + (height in the tip / h)^2.
    """
    foot, head, bend = column.foot_mm, column.head_mm, column.bend_mm
    length, tip = column.length_mm, column.tip_mm

    def distance(points_mm: np.ndarray) -> np.ndarray:
        # Column by column: sums over an axis of two are many times slower in numpy.
        z = points_mm[:, 2]
        u = z / length
        part = np.clip(u, 0.0, 1.0)
        moved = np.where(u < 1.0, u * u, 2.0 * u - 1.0)
        above = np.maximum(z - length, 0.0) / tip
        square, steep = above**2, np.zeros(len(z))
        along = above / tip
        for k in range(2):
            axis = foot[k] - (foot[k] - head[k]) * (2.0 * part - part * part)
            offset = (points_mm[:, k] - bend[k] * moved) / axis
            across = offset / axis
            taper = -2.0 * (foot[k] - head[k]) * (1.0 - part)
            square += offset**2
            steep += across**2
            along -= (across * (2.0 * bend[k] * part + offset * taper)) / length
        norm = np.sqrt(square)
        slope = np.sqrt(steep + along**2)
        return norm * (norm - 1.0) / np.maximum(slope, 1e-9)

    return distance


def column_body(column: Column, *, what: str) -> Any:
    """The column as a B-rep body, checked by its volume.

    Raises:
        GeometryError: If the kernel did not close it.
    """
    from build123d import Face, Wire

    ring = Wire([_ring_edge(column, quarter) for quarter in range(4)])
    body = sewn([*_patches(column), Face(ring)], what=what)
    return expect_volume(body, column.volume_mm3, what=what)


def _quarter(number: int) -> tuple[np.ndarray, np.ndarray]:
    """Control points (3, 2) and weights of a quarter of the unit circle; seams at 45 degrees."""
    start = math.pi / 2 * number - math.pi / 4
    ends = [(math.cos(t), math.sin(t)) for t in (start, start + math.pi / 2)]
    middle = start + math.pi / 4
    corner = (math.cos(middle) / QUARTER, math.sin(middle) / QUARTER)
    return np.array([ends[0], corner, ends[1]]), np.array([1.0, QUARTER, 1.0])


def _ring_edge(column: Column, number: int) -> Any:
    from build123d import Edge

    circle, weight = _quarter(number)
    points = circle * np.array(column.foot_mm)
    return Edge.make_bezier(*[(x, y, 0.0) for x, y in points.tolist()], weights=weight.tolist())


def _patches(column: Column) -> list[Any]:
    """Four patches of the side and four of the tip."""
    length, tip = column.length_mm, column.tip_mm
    foot, head, bend = (np.array(v) for v in (column.foot_mm, column.head_mm, column.bend_mm))
    ahead = bend * (1.0 + 2.0 * tip / length)
    # Rows of control points: height, half axes, centre, weight. The axis reaches `head` at half
    # height already because its slope there is that of 2 u - u^2: level at the top.
    side = [
        (0.0, foot, 0.0 * bend, 1.0),
        (length / 2, head, 0.0 * bend, 1.0),
        (length, head, bend, 1.0),
    ]
    end = [
        (length, head, bend, 1.0),
        (length + tip, head, ahead, QUARTER),
        (length + tip, 0.0 * head, ahead, 1.0),
    ]
    return [_patch(rows, number) for rows in (side, end) for number in range(4)]


def _patch(rows: list[tuple[float, np.ndarray, np.ndarray, float]], number: int) -> Any:
    from build123d import Face

    circle, weight = _quarter(number)
    points = [
        [(*(centre + axes * spot).tolist(), height) for spot in circle]
        for height, axes, centre, _ in rows
    ]
    weights = [(weight * row[3]).tolist() for row in rows]
    return Face.make_bezier_surface(points, weights)  # pyright: ignore[reportArgumentType]
