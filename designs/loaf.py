"""A loaf: half an ellipse on an upright wall, extruded along Y and revolved at both ends."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from geometry.body.outline import upright_and_dome
from workbench.core.base.booleans import expect_volume, fuse


@dataclass(frozen=True, kw_only=True, slots=True)
class Loaf:
    """Measures of a loaf that stands on z = 0 with its length along Y."""

    half_mm: float
    """Half the width, and the radius of the round ends."""
    straight_mm: float
    """Length of the straight part."""
    wall_mm: float
    """Height of the upright wall."""
    dome_mm: float
    """Height of the elliptic dome over it."""

    @property
    def top_mm(self) -> float:
        """Height of the ridge."""
        return self.wall_mm + self.dome_mm

    @property
    def volume_mm3(self) -> float:
        """Closed form: half-ellipse prism plus half-ellipsoid of revolution, each on its wall."""
        half, wall, dome = self.half_mm, self.wall_mm, self.dome_mm
        section = 2 * half * wall + math.pi / 2 * half * dome
        ends = math.pi * half**2 * (wall + 2.0 / 3.0 * dome)
        return section * self.straight_mm + ends

    def share(self, points_mm: np.ndarray) -> np.ndarray:
        """Distance from the ridge's line over the half width, in plan; (N, 2+) to (N,)."""
        along = np.maximum(np.abs(points_mm[:, 1]) - self.straight_mm / 2, 0.0)
        return np.hypot(points_mm[:, 0], along) / self.half_mm

    def roof_mm(self, points_mm: np.ndarray) -> np.ndarray:
        """Height of the dome over points in plan [mm], shape (N,)."""
        share = np.minimum(self.share(points_mm), 1.0)
        return self.wall_mm + self.dome_mm * np.sqrt(1.0 - share**2)

    def distance(self, points_mm: np.ndarray) -> np.ndarray:
        """Distance to the loaf [mm], first order: k (k - 1) / |grad k|, k the ellipse's norm."""
        across = self.share(points_mm) * self.half_mm
        above = np.maximum(points_mm[:, 2] - self.wall_mm, 0.0)
        norm = np.hypot(across / self.half_mm, above / self.dome_mm)
        slope = np.hypot(across / self.half_mm**2, above / self.dome_mm**2)
        return norm * (norm - 1.0) / np.maximum(slope, 1e-9)

    def prism(self, from_mm: float, to_mm: float) -> Any:
        """The upright prism on the loaf's outline between two heights.

        Raises:
            GeometryError: If its volume is not that of the closed form.
        """
        from build123d import Pos, SlotCenterToCenter, extrude

        # A round outline is a slot without a straight part, which the kernel refuses.
        if self.straight_mm > 1e-9:
            outline: Any = SlotCenterToCenter(self.straight_mm, 2 * self.half_mm, rotation=90)
        else:
            from build123d import Circle

            outline = Circle(self.half_mm)
        body = Pos(0, 0, from_mm) * extrude(outline, amount=to_mm - from_mm)
        area = math.pi * self.half_mm**2 + 2 * self.half_mm * self.straight_mm
        return expect_volume(body, area * (to_mm - from_mm), what="prism")


def loaf_body(loaf: Loaf) -> Any:
    """The solid loaf.

    Raises:
        GeometryError: If its volume is not that of the closed form.
    """
    return expect_volume(_joined(loaf, None), loaf.volume_mm3, what="loaf")


def loaf_shell(outside: Loaf, inside: Loaf) -> Any:
    """The wall between two loaves of the same length.

    Raises:
        GeometryError: If its volume is not that of the closed form.
    """
    expected_mm3 = outside.volume_mm3 - inside.volume_mm3
    return expect_volume(_joined(outside, inside), expected_mm3, what="shell of a loaf")


def _joined(outside: Loaf, inside: Loaf | None) -> Any:
    """Both ends and the straight part as one: faces meet in planes, where fusing is safe."""
    from build123d import Axis, Plane, Pos, Solid

    half = _half_section(outside, inside)
    body = Solid.revolve(half, 360.0, Axis.Z)
    if outside.straight_mm < 1e-9:
        return body
    reach = outside.straight_mm / 2
    mirrored = half.mirror(Plane.YZ)
    middle = fuse(
        Solid.extrude(half, (0, 2 * reach, 0)),
        Solid.extrude(mirrored, (0, 2 * reach, 0)),
        what="two sides of the loaf",
    )
    front = Solid.revolve(half, 180.0, Axis.Z)
    back = Solid.revolve(half, -180.0, Axis.Z)
    joined = fuse(Pos(0, -reach, 0) * middle, Pos(0, reach, 0) * front, what="front of the loaf")
    return fuse(joined, Pos(0, -reach, 0) * back, what="back of the loaf")


def _half_section(outside: Loaf, inside: Loaf | None) -> Any:
    """Half the section in the plane y = 0, at x >= 0."""
    from build123d import Edge, Face, Wire

    outer = upright_and_dome(outside.half_mm, outside.wall_mm, outside.dome_mm)
    if inside is None:
        lower, start, inner = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), []
    else:
        inner = upright_and_dome(inside.half_mm, inside.wall_mm, inside.dome_mm)
        lower, start = (0.0, 0.0, inside.top_mm), (inside.half_mm, 0.0, 0.0)
    foot = Edge.make_line(start, (outside.half_mm, 0.0, 0.0))
    ridge = Edge.make_line((0.0, 0.0, outside.top_mm), lower)
    return Face(Wire([foot, *outer, ridge, *inner]))
