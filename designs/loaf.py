"""A loaf: half an ellipse on an upright wall, drawn along Y, and an elliptic end at either side.

An end is half an elliptic disc, drawn up the wall, under a quarter of an ellipsoid.

Every face is a rational Bezier patch, which holds an ellipse exactly. The volume is

    (2 a w + pi/2 a d) s + pi/2 a (f + b) (w + 2/3 d)

with the half width a, wall w, dome d, straight length s and ends of length f and b.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from designs.shells import hollow, sewn
from geometry.body.outline import QUARTER
from workbench.core.base.booleans import expect_volume

SHORTEST_MM = 1e-9
"""A straight part or an upright wall shorter than this is none [mm]."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Loaf:
    """Measures of a loaf that stands on z = 0 with its length along Y."""

    half_mm: float
    """Half the width."""
    straight_mm: tuple[float, float]
    """Where along Y its straight part begins and ends."""
    ends_mm: tuple[float, float]
    """Lengths of the ends beyond that, toward -Y and toward +Y."""
    wall_mm: float
    """Height of the upright wall; 0 for none."""
    dome_mm: float
    """Height of the elliptic dome over it."""

    @property
    def top_mm(self) -> float:
        """Height of the ridge."""
        return self.wall_mm + self.dome_mm

    @property
    def area_mm2(self) -> float:
        """Area of the outline."""
        low, high = self.straight_mm
        return 2 * self.half_mm * (high - low) + math.pi / 2 * self.half_mm * sum(self.ends_mm)

    @property
    def volume_mm3(self) -> float:
        """Closed form of the module docstring."""
        half, wall, dome = self.half_mm, self.wall_mm, self.dome_mm
        low, high = self.straight_mm
        section = 2 * half * wall + math.pi / 2 * half * dome
        ends = math.pi / 2 * half * sum(self.ends_mm) * (wall + 2.0 / 3.0 * dome)
        return section * (high - low) + ends

    def share(self, points_mm: np.ndarray) -> np.ndarray:
        """Distance from the ridge's line over that of the outline, in plan; (N, 2+) to (N,)."""
        across, along, _ = self._shares(points_mm)
        return np.hypot(across, along)

    def roof_mm(self, points_mm: np.ndarray) -> np.ndarray:
        """Height of the dome over points in plan [mm], shape (N,)."""
        share = np.minimum(self.share(points_mm), 1.0)
        return self.wall_mm + self.dome_mm * np.sqrt(1.0 - share**2)

    def distance(self, points_mm: np.ndarray) -> np.ndarray:
        """Distance to the loaf [mm], first order: k (k - 1) / |grad k|, k the ellipse's norm."""
        across, along, end_mm = self._shares(points_mm)
        above = np.maximum(points_mm[:, 2] - self.wall_mm, 0.0) / self.dome_mm
        norm = np.sqrt(across**2 + along**2 + above**2)
        parts = across / self.half_mm, along / end_mm, above / self.dome_mm
        slope = np.sqrt(sum(part**2 for part in parts))
        return norm * (norm - 1.0) / np.maximum(slope, 1e-9)

    def _shares(self, points_mm: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Offsets over the half width and over the length of the end beside, and that length."""
        low, high = self.straight_mm
        y = points_mm[:, 1]
        end_mm = np.where(y < low, self.ends_mm[0], self.ends_mm[1])
        along = np.maximum(np.maximum(low - y, y - high), 0.0) / end_mm
        return points_mm[:, 0] / self.half_mm, along, end_mm

    def prism(self, from_mm: float, to_mm: float) -> Any:
        """The upright prism on the loaf's outline between two heights.

        Raises:
            GeometryError: If its volume is not that of the closed form.
        """
        from build123d import Face, Pos, Solid, Vector, Wire

        outline = Face(Wire(_outline(self)))
        body = Pos(0, 0, from_mm) * Solid.extrude(outline, Vector(0, 0, to_mm - from_mm))
        return expect_volume(body, self.area_mm2 * (to_mm - from_mm), what="prism")


def loaf_body(loaf: Loaf) -> Any:
    """The solid loaf.

    Raises:
        GeometryError: If its volume is not that of the closed form.
    """
    from build123d import Face, Wire

    faces = [*_patches(loaf), Face(Wire(_outline(loaf)))]
    return expect_volume(sewn(faces, what="loaf"), loaf.volume_mm3, what="loaf")


def loaf_shell(outside: Loaf, inside: Loaf) -> Any:
    """The wall between two loaves.

    Raises:
        GeometryError: If its volume is not that of the closed form.
    """
    shell = hollow(loaf_body(outside), loaf_body(inside), what="shell of a loaf")
    expected_mm3 = outside.volume_mm3 - inside.volume_mm3
    return expect_volume(shell, expected_mm3, what="shell of a loaf")


Plan = tuple[np.ndarray, np.ndarray, np.ndarray]
"""Piece of the outline: middle and offsets from it of its control points, shapes (2,) and (K, 2),
and their weights (K,). Toward the ridge the offsets shrink."""


def _pieces(loaf: Loaf) -> list[Plan]:
    """The outline around, from the end toward +Y on."""
    low, high = loaf.straight_mm
    half, (back, front) = loaf.half_mm, loaf.ends_mm
    weights = np.array([1.0, QUARTER, 1.0])
    found = []
    for side, y, end in ((1, high, front), (-1, high, front), (-1, low, -back), (1, low, -back)):
        corners = np.array([[side * half, 0.0], [side * half, end], [0.0, end]])
        forward = side * end > 0.0
        found.append((np.array([0.0, y]), corners if forward else corners[::-1], weights))
    if high - low > SHORTEST_MM:
        for side, place in ((-1, 2), (1, 5)):
            ends = (high, low) if side < 0 else (low, high)
            offsets = np.array([[side * half, 0.0], [side * half, 0.0]])
            # Along the straight part each control point has its own middle.
            middle = np.array([[0.0, y] for y in ends])
            found.insert(place, (middle, offsets, np.ones(2)))
    return found


def _outline(loaf: Loaf) -> list[Any]:
    from build123d import Edge

    edges = []
    for middle, offsets, weights in _pieces(loaf):
        points = [(x, y, 0.0) for x, y in (middle + offsets).tolist()]
        if len(points) == 2:
            edges.append(Edge.make_line(*points))
        else:
            edges.append(Edge.make_bezier(*points, weights=weights.tolist()))
    return edges


def _patches(loaf: Loaf) -> list[Any]:
    """Faces over each piece of the outline: the upright wall, if any, and the dome."""
    from build123d import Face

    wall, top = loaf.wall_mm, loaf.top_mm
    # Height, share of the offsets, weight of each row of control points.
    rises = [[(wall, 1.0, 1.0), (top, 1.0, QUARTER), (top, 0.0, 1.0)]]
    if wall > SHORTEST_MM:
        rises.append([(0.0, 1.0, 1.0), (wall, 1.0, 1.0)])
    faces = []
    for rows in rises:
        for middle, offsets, weights in _pieces(loaf):
            points = [
                [(x, y, z) for x, y in (middle + share * offsets).tolist()] for z, share, _ in rows
            ]
            weighted = [(weight * weights).tolist() for _, _, weight in rows]
            faces.append(Face.make_bezier_surface(points, weighted))  # pyright: ignore[reportArgumentType]
    return faces
