"""A bent arm: an ellipse swept along a circle, from a level foot to a flat end across the arm.

With the bend's axis along X at y = R, z = 0, a point at the distance rho from it and the angle a
over the base has y = R - rho cos a, z = rho sin a. The arm is

    (x / half_x)^2 + ((rho - R) / half_y)^2 <= 1,   0 <= a <= turn,

so its volume is pi half_x half_y R turn (Pappus). A smaller arm inside has half axes less by the
wall and ends sooner, so that the end is as thick as the wall where it is thinnest. As sections are
alike, it slides out along its own arc.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from designs import distance
from geometry.body.outline import QUARTER
from workbench.core.base.booleans import expect_volume
from workbench.core.result.marks import Field

AROUND = 181
"""Places around half a section at which the wall is measured."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Arm:
    """A bent arm that stands on z = 0 and leans toward +Y."""

    half_mm: tuple[float, float]
    """Half axes of a section: along X, and toward the bend's axis [mm]."""
    bend_radius_mm: float
    """From the bend's axis to the middle of the arm."""
    turn: float
    """Angle from the foot to the end [radian]."""

    def inset(self, wall_mm: float) -> Arm:
        """The arm smaller by a wall on its sides and, at least, at its end."""
        half_x, half_y = (half - wall_mm for half in self.half_mm)
        nearest_mm = self.bend_radius_mm - half_y
        return replace(self, half_mm=(half_x, half_y), turn=self.turn - wall_mm / nearest_mm)

    @property
    def volume_mm3(self) -> float:
        """Closed form of the module docstring [mm3]."""
        return math.pi * self.half_mm[0] * self.half_mm[1] * self.bend_radius_mm * self.turn

    def place_mm(self, angle: float, out_mm: float, x_mm: float = 0.0) -> np.ndarray:
        """Place at an angle over the base, so far from the middle line away from the axis, (3,)."""
        rho = self.bend_radius_mm + out_mm
        return np.array([x_mm, self.bend_radius_mm - rho * math.cos(angle), rho * math.sin(angle)])

    def ridge_mm(self, x_mm: np.ndarray) -> np.ndarray:
        """How far the side away from the axis is from the middle line, over x [mm]."""
        half_x, half_y = self.half_mm
        return half_y * np.sqrt(np.maximum(1.0 - np.square(x_mm / half_x), 0.0))

    def beyond_mm(self, points_mm: np.ndarray) -> np.ndarray:
        """Distance of points from the plane of the end, away from the arm [mm], shape (N,)."""
        # The plane holds the bend's axis.
        aside = points_mm[:, 1] - self.bend_radius_mm
        return math.cos(self.turn) * points_mm[:, 2] + math.sin(self.turn) * aside

    def least_wall_mm(self, wall_mm: float) -> float:
        """Thinnest place between the arm's side and that of its inset [mm]."""
        turn = np.linspace(0.0, np.pi, AROUND)
        inner = np.array(self.half_mm) - wall_mm
        section = inner * np.column_stack([np.cos(turn), np.sin(turn)])
        return float(-distance.ellipse(section, *self.half_mm).max())

    def box_mm(self) -> tuple[np.ndarray, np.ndarray]:
        """Corners of the box around it [mm], shape (3,) each."""
        angles = np.linspace(0.0, self.turn, AROUND)
        half_x, half_y = self.half_mm
        spots = [self.place_mm(a, out) for a in angles.tolist() for out in (-half_y, half_y)]
        low, high = np.min(spots, axis=0), np.max(spots, axis=0)
        low[0], high[0] = -half_x, half_x
        return low, high


def arm_body(arm: Arm, *, what: str) -> Any:
    """The arm as a B-rep body, checked by its volume.

    Raises:
        GeometryError: If its volume is not that of the closed form.
    """
    from build123d import Axis, Edge, Face, Solid, Wire

    half_x, half_y = arm.half_mm
    # Rational quarters hold the ellipse exactly; revolved as an ellipse, it comes back from a STEP
    # file with its axes exchanged.
    ends = [(half_x, 0.0), (0.0, half_y), (-half_x, 0.0), (0.0, -half_y), (half_x, 0.0)]
    corners = [(half_x, half_y), (-half_x, half_y), (-half_x, -half_y), (half_x, -half_y)]
    quarters = [
        Edge.make_bezier((*start, 0.0), (*corner, 0.0), (*stop, 0.0), weights=[1.0, QUARTER, 1.0])
        for start, corner, stop in zip(ends[:-1], corners, ends[1:], strict=True)
    ]
    axis = Axis((0.0, arm.bend_radius_mm, 0.0), (-1.0, 0.0, 0.0))
    body = Solid.revolve(Face(Wire(quarters)), math.degrees(arm.turn), axis)
    return expect_volume(body, arm.volume_mm3, what=what)


def arm_field(arm: Arm) -> Field:
    """Signed distance to an arm above z = 0, first order at its side."""

    def field(points_mm: np.ndarray) -> np.ndarray:
        from_axis_mm = np.hypot(points_mm[:, 1] - arm.bend_radius_mm, points_mm[:, 2])
        out = from_axis_mm - arm.bend_radius_mm
        side = distance.ellipse(np.column_stack([points_mm[:, 0], out]), *arm.half_mm)
        return np.maximum(side, arm.beyond_mm(points_mm))

    return field
