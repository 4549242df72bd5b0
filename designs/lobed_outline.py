"""A round outline with smooth bulges, seen whole from its axis: r(phi) in polar coordinates.

    r(phi) = radius + bulge sum_i exp(k (cos(phi - phi_i) - 1)),   less an inset along the normal.

Area, perimeter and the narrowest bend are sums over a fine table. Leaves out: insets so deep that
the normals cross.
"""

from __future__ import annotations

from typing import Any

import numpy as np

SHARPNESS = 14.0
"""k of the bulges: each is about 30 degrees wide."""
OUTLINE_POINTS = 48
"""Points through which the outline is drawn: within 0.005 mm on 60 random paws. Fewer are faster,
but the kernel then fails to round twice as many cores."""
SAMPLES = 1440


class LobedOutline:
    """An outline about the axis, less by an inset.

    Args:
        radius_mm: Of the outline between its bulges.
        bulge_mm: How far they stand out.
        bulges_rad: Azimuth of each, shape (K,).
        inset_mm: How much less it is, measured along the outer normal.
    """

    def __init__(
        self, *, radius_mm: float, bulge_mm: float, bulges_rad: np.ndarray, inset_mm: float
    ) -> None:
        self._radius_mm, self._bulge_mm = radius_mm, bulge_mm
        self._bulges_rad, self._inset_mm = bulges_rad, inset_mm
        # The kernel's spline begins and ends at -Y, where the outline is plain.
        self.turn = -np.pi / 2 + np.arange(SAMPLES) * (2.0 * np.pi / SAMPLES)
        radius = self.radius(self.turn)
        self.points_mm = radius[:, None] * np.column_stack([np.cos(self.turn), np.sin(self.turn)])
        step = 2.0 * np.pi / SAMPLES
        first = (np.roll(radius, -1) - np.roll(radius, 1)) / (2.0 * step)
        second = (np.roll(radius, -1) - 2.0 * radius + np.roll(radius, 1)) / step**2
        speed = np.hypot(radius, first)
        self.least_mm = float(radius.min())
        self.greatest_mm = float(radius.max())
        self.area_mm2 = float((radius**2).mean() * np.pi)
        self.perimeter_mm = float(speed.mean() * 2.0 * np.pi)
        bend = (radius**2 + 2.0 * first**2 - radius * second) / speed**3
        self.bend_mm = float(1.0 / bend.max())
        """Radius of the narrowest convex bend."""

    def radius(self, turn: np.ndarray) -> np.ndarray:
        """Distance from the axis [mm] by azimuth [rad], both of shape (N,)."""
        away = turn[:, None] - self._bulges_rad
        bulge = self._bulge_mm * np.exp(SHARPNESS * (np.cos(away) - 1.0))
        outside = self._radius_mm + bulge.sum(axis=1)
        slope = -(SHARPNESS * np.sin(away) * bulge).sum(axis=1)
        return outside - self._inset_mm * np.sqrt(1.0 + (slope / outside) ** 2)

    def edges(self) -> list[Any]:
        """The outline as two edges in the plane z = 0.

        Two, because the kernel integrates the area inside one long spline to 1e-3 only, inside
        its halves to 1e-5.
        """
        from build123d import Edge

        spots = self.points_mm[:: SAMPLES // OUTLINE_POINTS]
        whole = Edge.make_spline([(x, y, 0.0) for x, y in spots.tolist()], periodic=True)
        return [whole.trim(0.0, 0.5), whole.trim(0.5, 1.0)]

    def distance(self, points_mm: np.ndarray) -> np.ndarray:
        """Signed distance to the outline, first order, shape (N,)."""
        beside = np.hypot(points_mm[:, 0], points_mm[:, 1])
        turn = np.arctan2(points_mm[:, 1], points_mm[:, 0])
        # Interpolated in a table: the exponentials of four toes a point would take seconds.
        table = np.append(self.turn, self.turn[0] + 2.0 * np.pi)
        radius = np.linalg.norm(self.points_mm, axis=1)
        slope = np.gradient(np.concatenate([radius[-1:], radius, radius[:1]]))[1:-1]
        slope *= SAMPLES / (2.0 * np.pi)
        around = (turn + np.pi / 2) % (2.0 * np.pi) - np.pi / 2
        here = np.interp(around, table, np.append(radius, radius[0]))
        rise = np.interp(around, table, np.append(slope, slope[0]))
        return (beside - here) / np.sqrt(1.0 + (rise / np.maximum(beside, here / 2)) ** 2)
