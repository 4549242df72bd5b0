"""A digit: a leaning column of rounded rectangular sections that rises into a rounded tip.

Every level section is a rectangle with elliptic corners: half sizes a along X and b along Y,
corner radii r along X and s along Y, middle y. All five, with the height z, are rational quadratic
in three stages, so Bezier patches hold the body exactly:

    lean       from the base: straight, with the slope of the lean,
    rise       the slope goes evenly to that of the tip, and sizes to those at its root,
    tip        control row where the tangents of the rise meet the top's plane, weight sqrt(1/2), so
               that a straight-sided round digit ends in half an ellipsoid.

Corners of the tip's control row are whole quarters of an ellipse: flats fade toward the top. Then

    volume = integral of 4 a b - (4 - pi) r s over z.

Leaves out: lean to the sides, twist.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from designs.shells import sewn
from geometry.body.outline import QUARTER
from workbench.core.base.booleans import expect_volume

STEP_MM = 1e-4
"""Step of the slope of the level distance along Z [mm]."""
CAP_SHARE = 1e-3
"""Share of the tip's height that the field leaves out at the top, where sections shrink to none."""
NODES = 60
BOX_SECTIONS = 400
SIDES = ((1, 1), (-1, 1), (-1, -1), (1, -1))
"""Signs of the corners along X and Y, counter-clockwise."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Digit:
    """A digit on z = 0 whose base is centred on the axis and that leans toward +Y."""

    half_mm: tuple[float, float]
    """Half sizes along X and Y at the base [mm]."""
    corner_mm: tuple[float, float]
    """Radii of the corners along X and Y at the base [mm]."""
    root_mm: tuple[float, float]
    """Half sizes where the tip begins [mm]."""
    straight_mm: float
    """Height at which the lean begins to end [mm]."""
    length_mm: float
    """Height at which the tip begins [mm]."""
    tip_mm: float
    """Height of the tip above that [mm]."""
    lean: float
    """Slope dy/dz of the middle from the base on."""
    tip_lean: float
    """The same of the tip."""

    @property
    def rows(self) -> np.ndarray:
        """Control rows of the stages (z, y, a, b, r, s) [mm], shape (3, 3, 6)."""
        rise = (self.length_mm - self.straight_mm) / 2
        low = np.array([0.0, 0.0, *self.half_mm, *self.corner_mm])
        bend, middle = low.copy(), low.copy()
        bend[:2] = self.straight_mm, self.lean * self.straight_mm
        middle[:2] = self.straight_mm + rise, self.lean * (self.straight_mm + rise)
        between = (low + bend) / 2
        root, crown = middle.copy(), middle.copy()
        root[:2] += rise * np.array([1.0, self.tip_lean])
        crown[:2] = root[:2] + self.tip_mm * np.array([1.0, self.tip_lean])
        share = self.tip_mm / rise
        root[2:4] = self.root_mm
        crown[2:4] = root[2:4] + share * (root[2:4] - middle[2:4])
        # Corners go on evenly too, to be whole at the crown: r + share (r - r_low) = a.
        crown[4:] = crown[2:4]
        root[4:] = (crown[4:] + share * middle[4:]) / (1.0 + share)
        apex = crown.copy()
        apex[2:] = 0.0
        return np.array([[low, between, bend], [bend, middle, root], [root, crown, apex]])

    @property
    def top_mm(self) -> float:
        """Height of the highest point [mm]."""
        return self.length_mm + self.tip_mm

    @property
    def volume_mm3(self) -> float:
        """Quadrature of the module docstring [mm3]; the integrand is smooth in each stage."""
        node, weight = np.polynomial.legendre.leggauss(NODES)
        total = 0.0
        for number, rows in enumerate(self.rows):
            share = (node + 1.0) / 2.0
            places, moved = _blend(rows, share, number)
            area = 4.0 * places[:, 2] * places[:, 3] - (4.0 - math.pi) * places[:, 4] * places[:, 5]
            total += float(weight @ (area * moved)) / 2.0
        return total

    def sections(self, z_mm: np.ndarray) -> np.ndarray:
        """Middle y, half sizes and corner radii of level sections [mm], shape (N, 5)."""
        ends = np.array([0.0, self.straight_mm, self.length_mm, self.top_mm])
        z = np.clip(z_mm, 0.0, self.top_mm - CAP_SHARE * self.tip_mm)
        stage = np.clip(np.searchsorted(ends, z, side="right") - 1, 0, 2)
        found = np.empty((len(z), 5))
        for number, rows in enumerate(self.rows):
            here = stage == number
            share = (z[here] - ends[number]) / (ends[number + 1] - ends[number])
            if number == 2:
                # z is 1 - (1 - t)^2 / D of the stage's height: solved for t / (1 - t).
                ratio = np.sqrt(QUARTER**2 - 1.0 + 1.0 / (1.0 - share)) - QUARTER
                share = ratio / (1.0 + ratio)
            found[here] = _blend(rows, share, number)[0][:, 1:]
        return found

    def distance(self, points_mm: np.ndarray) -> np.ndarray:
        """Signed distance [mm], first order, shape (N,): the level one over its slope in space."""
        level = self._level(points_mm, 0.0)
        rise = (self._level(points_mm, STEP_MM) - self._level(points_mm, -STEP_MM)) / (2 * STEP_MM)
        over = points_mm[:, 2] - (self.top_mm - CAP_SHARE * self.tip_mm)
        return np.where(
            over > 0.0, np.hypot(over, np.maximum(level, 0.0)), level / np.sqrt(1.0 + rise**2)
        )

    def back_mm(self, x_mm: np.ndarray, z_mm: np.ndarray) -> np.ndarray:
        """y of the back (toward -Y) over x and z [mm]; not a number beside the body."""
        y, a, b, r, s = self.sections(z_mm).T
        with np.errstate(divide="ignore", invalid="ignore"):
            aside = np.maximum(np.abs(x_mm) - (a - r), 0.0) / r
            return y - b + s - s * np.sqrt(1.0 - aside**2)

    def box_mm(self) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
        """Corners of the box around it [mm], by its sections."""
        y, a, b, _, _ = self.sections(np.linspace(0.0, self.top_mm, BOX_SECTIONS)).T
        half = float(a.max())
        return (-half, float((y - b).min()), 0.0), (half, float((y + b).max()), self.top_mm)

    def _level(self, points_mm: np.ndarray, lift_mm: float) -> np.ndarray:
        """Distance in the section at the height of each point, or a little above."""
        y, a, b, r, s = self.sections(points_mm[:, 2] + lift_mm).T
        u = np.abs(points_mm[:, 0]) - a + r
        v = np.abs(points_mm[:, 1] - y) - b + s
        r, s = np.maximum(r, 1e-9), np.maximum(s, 1e-9)
        norm = np.sqrt((u / r) ** 2 + (v / s) ** 2)
        slope = np.hypot(u / r**2, v / s**2)
        corner = norm * (norm - 1.0) / np.maximum(slope, 1e-9)
        return np.where((u > 0.0) & (v > 0.0), corner, np.maximum(u - r, v - s))


def digit_body(digit: Digit, *, what: str) -> Any:
    """The digit as a B-rep body, checked by its volume.

    Raises:
        GeometryError: If the kernel did not close it.
    """
    from build123d import Edge, Face, Wire

    faces = []
    for number, rows in enumerate(digit.rows):
        weights = (1.0, QUARTER if number == 2 else 1.0, 1.0)
        loops = [_loop(row) for row in rows]
        for piece in range(8):
            points = [[tuple(spot) for spot in loop[piece].tolist()] for loop in loops]
            across = (1.0, QUARTER, 1.0) if piece % 2 == 0 else (1.0, 1.0)
            grid = [[along * w for w in across] for along in weights]
            faces.append(Face.make_bezier_surface(points, grid))  # pyright: ignore[reportArgumentType]
    ring = []
    for piece, spots in enumerate(_loop(digit.rows[0, 0])):
        rational = [1.0, QUARTER, 1.0] if piece % 2 == 0 else None
        ring.append(Edge.make_bezier(*[tuple(spot) for spot in spots.tolist()], weights=rational))
    body = sewn([*faces, Face(Wire(ring))], what=what)
    return expect_volume(body, digit.volume_mm3, what=what)


def _blend(rows: np.ndarray, share: np.ndarray, number: int) -> tuple[np.ndarray, np.ndarray]:
    """Rows at shares t of a stage, shape (N, 6), and dz/dt [mm], shape (N,)."""
    weight = QUARTER if number == 2 else 1.0
    t = share[:, None]
    parts = np.hstack([(1.0 - t) ** 2, 2.0 * weight * t * (1.0 - t), t**2])
    slopes = np.hstack([-2.0 * (1.0 - t), 2.0 * weight * (1.0 - 2.0 * t), 2.0 * t])
    whole, change = parts.sum(axis=1, keepdims=True), slopes.sum(axis=1, keepdims=True)
    places = parts @ rows / whole
    return places, ((slopes @ rows - places * change) / whole)[:, 0]


def _loop(row: np.ndarray) -> list[np.ndarray]:
    """Control points of a section: corner and flat in turn, each (3 or 2, 3)."""
    z, y, a, b, r, s = row.tolist()
    pieces = []
    for number, (sx, sy) in enumerate(SIDES):
        corner = np.array([sx * a, y + sy * b, z])
        beside = corner - [0.0, sy * s, 0.0]
        above = corner - [sx * r, 0.0, 0.0]
        ends = (beside, above) if number % 2 == 0 else (above, beside)
        pieces.append(np.array([ends[0], corner, ends[1]]))
    closed = [*pieces, pieces[0]]
    flats = [np.array([closed[k][2], closed[k + 1][0]]) for k in range(4)]
    return [part for pair in zip(pieces, flats, strict=True) for part in pair]
