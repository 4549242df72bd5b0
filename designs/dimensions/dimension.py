"""A size as a drawing shows it: a line beside the body whose end is dragged, and what it leaves.

A family's file beside this one has `DIMENSIONS`, a function of shape and layers; a family without a
file has none. They stand apart from the families, whose code records rest on.

All lines lie where the eye that looks at a body first (from +X, +Y and above) sees them before or
beside it: upright ones at the left, level ones at the base in front.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

Point = tuple[float, float, float]
LEFT = (0.6, -0.8)
"""Unit direction along X and Y toward the left of that eye."""
GAP_MM = 5.0
"""From the body to the lines beside it, and from one row of lines to the next."""
ELASTOMER = "layers.elastomer_mm"


@dataclass(frozen=True, kw_only=True, slots=True)
class Dimension:
    """One line."""

    field: str
    """Of the design, for example `shape.outer_radius_mm`."""
    start_mm: Point
    """The end that stays where it is."""
    stop_mm: Point
    """The end that is dragged along the line."""
    feet_mm: tuple[Point, ...] = ()
    """Places on the body that both ends are drawn out from, that of the start first."""
    per_mm: float = 1.0
    """How much the field changes while the end goes one mm away from the start."""

    @property
    def direction(self) -> np.ndarray:
        """Unit vector from start to stop, shape (3,)."""
        way = np.subtract(self.stop_mm, self.start_mm)
        return way / np.linalg.norm(way)


def across(field: str, half_mm: tuple[float, float], axis: int) -> Dimension:
    """A whole size along X (`axis` 0) or Y (1) at the base, dragged at the end far from the eye.

    Args:
        field: Of the design.
        half_mm: Half sizes of the body along X and Y.
        axis: 0 or 1.
    """
    end_mm = half_mm[axis]
    foot_at = np.zeros((2, 3))
    foot_at[:, axis] = end_mm, -end_mm
    ends = foot_at.copy()
    ends[:, 1 - axis] = half_mm[1 - axis] + GAP_MM
    return Dimension(
        field=field,
        start_mm=_point(ends[0]),
        stop_mm=_point(ends[1]),
        feet_mm=(_point(foot_at[0]), _point(foot_at[1])),
        per_mm=2.0,
    )


def upright(
    field: str,
    heights_mm: tuple[float, float],
    side_mm: tuple[float, float],
    *,
    feet_mm: tuple[Point, ...] = (),
    rows: int = 1,
    per_mm: float = 1.0,
) -> Dimension:
    """A size along Z at the left of the body, dragged at its second height.

    Args:
        field: Of the design.
        heights_mm: Where it begins and ends.
        side_mm: X and Y of the body's leftmost place.
        feet_mm: Places on the body; without them those at the side.
        rows: How many rows out from the body.
        per_mm: As of `Dimension`.
    """
    x, y = (place + rows * GAP_MM * toward for place, toward in zip(side_mm, LEFT, strict=True))
    low, high = heights_mm
    at_side = ((*side_mm, low), (*side_mm, high))
    return Dimension(
        field=field,
        start_mm=(x, y, low),
        stop_mm=(x, y, high),
        feet_mm=feet_mm or at_side,
        per_mm=per_mm,
    )


def wall_at_base(half_mm: tuple[float, float], wall_mm: float) -> Dimension:
    """The elastomer's thickness on +X at the base, one row farther out than the width."""
    x, y = half_mm[0], half_mm[1] + 2 * GAP_MM
    return Dimension(
        field=ELASTOMER,
        start_mm=(x, y, 0.0),
        stop_mm=(x - wall_mm, y, 0.0),
        feet_mm=((x, 0.0, 0.0), (x - wall_mm, 0.0, 0.0)),
    )


def leftmost(half_mm: tuple[float, float]) -> tuple[float, float]:
    """X and Y of the place of an ellipse about the axis that is farthest to the left [mm]."""
    reach = float(np.hypot(half_mm[0] * LEFT[0], half_mm[1] * LEFT[1]))
    return half_mm[0] ** 2 * LEFT[0] / reach, half_mm[1] ** 2 * LEFT[1] / reach


def _point(place: np.ndarray) -> Point:
    x, y, z = place.tolist()
    return x, y, z
