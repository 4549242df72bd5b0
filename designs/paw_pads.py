"""Pads of a paw: caps of balls on a flat top, four for the toes and a large one drawn out along X.

A pad is a ball that cuts the top in a circle, so with its radius a there and its rise h

    volume = pi h (3 a^2 + h^2) / 6 + length (R^2 acos((R - h) / R) - (R - h) a),
    R = (a^2 + h^2) / (2 h).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from workbench.core.base.errors import DesignError, GeometryError
from workbench.core.result.marks import Field

BETWEEN_MM = 0.4
"""Smallest gap between pads, and from a pad to the rounded rim [mm]."""
STEEPEST = 0.95
"""Highest pad over its radius: at 1 its side would stand upright on the top."""
APEX_MM = 1e-3
"""How near the highest point of a pad's faces must be to the height asked for [mm]."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Pads:
    """All pads of a paw."""

    toe_places_mm: np.ndarray
    """Middle of each toe pad [mm], shape (T, 2)."""
    toe_mm: float
    """Radius of a toe pad where it leaves the top [mm]."""
    large_ends_mm: np.ndarray
    """Ends of the large pad's middle line, which is along X [mm], shape (2, 2)."""
    large_mm: float
    """Half width of the large pad where it leaves the top [mm]."""
    rise_mm: float
    """How far they stand out of the top [mm]."""
    top_mm: float
    """Height of the flat top [mm]."""

    def ball_mm(self, radius_mm: float) -> tuple[float, float]:
        """Radius of the ball of a pad of this radius, and height of its centre [mm]."""
        ball_mm = (radius_mm**2 + self.rise_mm**2) / (2.0 * self.rise_mm)
        return ball_mm, self.top_mm + self.rise_mm - ball_mm

    @property
    def volume_mm3(self) -> float:
        """Volume of all pads above the top [mm3]."""
        start, stop = self.large_ends_mm
        large = cap_mm3(self.large_mm, self.rise_mm, float(stop[0] - start[0]))
        return len(self.toe_places_mm) * cap_mm3(self.toe_mm, self.rise_mm, 0.0) + large


def cap_mm3(radius_mm: float, rise_mm: float, length_mm: float) -> float:
    """Volume of a spherical cap, drawn out by a length [mm3]; see the module docstring."""
    ball_mm = (radius_mm**2 + rise_mm**2) / (2.0 * rise_mm)
    under = ball_mm - rise_mm
    segment = ball_mm**2 * math.acos(under / ball_mm) - under * radius_mm
    return math.pi * rise_mm * (3.0 * radius_mm**2 + rise_mm**2) / 6.0 + length_mm * segment


def check_pads(pads: Pads, outline_mm: np.ndarray, rim_mm: float) -> None:
    """Refuse pads that are too steep, touch each other or reach into the rim.

    Args:
        outline_mm: Outline of the body, shape (N, 2).
        rim_mm: Radius of its rounded top rim.

    Raises:
        DesignError: Naming the field, its value and its limit.
    """
    for name, radius_mm in (("toe_pad_mm", pads.toe_mm), ("large_pad_mm", pads.large_mm)):
        if pads.rise_mm > STEEPEST * radius_mm:
            raise DesignError(
                f"pads {pads.rise_mm:g} mm high overhang at a radius of {radius_mm:g} "
                f"mm; the limit is {STEEPEST:g} times the radius",
                hint=f"lower shape.pad_mm or raise shape.{name}",
                at="shape.pad_mm",
            )
    toes, large = pads.toe_places_mm, pads.large_ends_mm
    gaps = {
        "toe pads": np.linalg.norm(np.diff(toes, axis=0), axis=1) - 2 * pads.toe_mm,
        "toe pads and large pad": _flat_segment(toes, large) - pads.toe_mm - pads.large_mm,
        "large pad and rim": _flat_segment(outline_mm, large) - pads.large_mm - rim_mm,
        "toe pads and rim": _nearest(toes, outline_mm) - pads.toe_mm - rim_mm,
    }
    for what, gap in gaps.items():
        # Toe pads stand at the smallest gap from the rim by design, but for the bend of the toe.
        least_mm = BETWEEN_MM / 2 if what == "toe pads and rim" else BETWEEN_MM
        if gap.min() < least_mm:
            raise DesignError(
                f"{what} are {float(gap.min()):.2g} mm apart, less than {least_mm:g} mm",
                hint="lower shape.toe_pad_mm or shape.large_pad_mm, or raise shape.radius_mm",
                at="shape.large_pad_mm" if "large" in what else "shape.toe_pad_mm",
            )


def _nearest(points_mm: np.ndarray, others_mm: np.ndarray) -> np.ndarray:
    return np.linalg.norm(points_mm[:, None] - others_mm[None], axis=2).min(axis=1)


def _flat_segment(points_mm: np.ndarray, ends_mm: np.ndarray) -> np.ndarray:
    """Distance of points (N, 2) to a segment along X [mm]."""
    beyond = np.maximum(np.abs(points_mm[:, 0]) - ends_mm[1, 0], 0.0)
    return np.hypot(beyond, points_mm[:, 1] - ends_mm[0, 1])


def pads_field(pads: Pads) -> Field:
    """Signed distance to all pads, which go on a little below the top."""
    low_mm = pads.top_mm - 0.5 * BETWEEN_MM
    toe, large = pads.ball_mm(pads.toe_mm), pads.ball_mm(pads.large_mm)

    def above(points_mm: np.ndarray) -> np.ndarray:
        balls = [_to_segment(points_mm, pads.large_ends_mm, large[1]) - large[0]]
        for place in pads.toe_places_mm:
            balls.append(_to_segment(points_mm, np.stack([place, place]), toe[1]) - toe[0])
        return np.maximum(np.minimum.reduce(balls), low_mm - points_mm[:, 2])

    return above


def _to_segment(points_mm: np.ndarray, ends_mm: np.ndarray, height_mm: float) -> np.ndarray:
    """Distance to a level segment along X [mm]: the middle line of a pad's ball."""
    x = points_mm[:, 0] - np.clip(points_mm[:, 0], ends_mm[0, 0], ends_mm[1, 0])
    rest = (points_mm[:, 1] - ends_mm[0, 1]) ** 2 + (points_mm[:, 2] - height_mm) ** 2
    return np.sqrt(x**2 + rest)


def pad_bodies(pads: Pads) -> list[Any]:
    """All pads; the large one in three solids that touch."""
    from build123d import Axis, Face, Pos, Solid

    half, _ = _profile(pads, pads.toe_mm)
    cap = Solid.revolve(Face(half), 360.0, Axis.Z)
    toes = [Pos(x, y, 0.0) * cap for x, y in pads.toe_places_mm.tolist()]
    return [*toes, *_large_pad(pads)]


def _large_pad(pads: Pads) -> list[Any]:
    """A cap drawn out along X: the segment between two half caps, and these."""
    from build123d import Axis, Face, Pos, Rot, Solid, Vector

    half, whole = _profile(pads, pads.large_mm)
    (start, y), (stop, _) = pads.large_ends_mm.tolist()
    middle = Solid.extrude(Rot(0, 0, 90) * Face(whole), Vector(stop - start, 0, 0))
    end = Rot(0, 0, -90) * Solid.revolve(Face(half), 180.0, Axis.Z)
    return [
        Pos(start, y, 0) * middle,
        Pos(stop, y, 0) * end,
        Pos(start, y, 0) * (Rot(0, 0, 180) * end),
    ]


def _profile(pads: Pads, radius_mm: float) -> tuple[Any, Any]:
    """Half a pad's section in the plane y = 0 as a wire, and its mirror image with it as a wire.

    The ball goes on a little below the top, where it is still under the flat part of it.
    """
    from build123d import Edge, Wire

    ball_mm, centre_mm = pads.ball_mm(radius_mm)
    deep_mm = pads.top_mm - 0.4 * BETWEEN_MM * radius_mm / ball_mm
    across = math.sqrt(ball_mm**2 - (deep_mm - centre_mm) ** 2)
    apex = (0.0, 0.0, pads.top_mm + pads.rise_mm)
    corner, foot = (across, 0.0, deep_mm), (0.0, 0.0, deep_mm)
    slant = math.atan2(across, deep_mm - centre_mm) / 2
    middle = (ball_mm * math.sin(slant), 0.0, centre_mm + ball_mm * math.cos(slant))
    arc = Edge.make_three_point_arc(corner, middle, apex)
    half = Wire([Edge.make_line(foot, corner), arc, Edge.make_line(apex, foot)])
    whole_arc = Edge.make_three_point_arc(corner, apex, (-across, 0.0, deep_mm))
    whole = Wire([whole_arc, Edge.make_line((-across, 0.0, deep_mm), corner)])
    return half, whole


def expect_pads(outer: Any, pads: Pads) -> None:
    """Each pad must have a face that rises above the top over the pad's middle.

    Raises:
        GeometryError: If one is missing.
    """
    boxes = [face.bounding_box(optimal=False) for face in outer.faces()]
    tops = [box for box in boxes if box.max.Z > pads.top_mm + pads.rise_mm - APEX_MM]
    places = [*pads.toe_places_mm.tolist(), pads.large_ends_mm.mean(axis=0).tolist()]
    for number, (x, y) in enumerate(places):
        found = any(
            box.min.X <= x + APEX_MM
            and x - APEX_MM <= box.max.X
            and box.min.Y <= y + APEX_MM
            and y - APEX_MM <= box.max.Y
            for box in tops
        )
        if not found:
            raise GeometryError(
                f"pad {number + 1} of {len(places)} is not there",
                hint="change shape.toe_pad_mm or shape.large_pad_mm a little",
                at="shape.toe_pad_mm",
            )
