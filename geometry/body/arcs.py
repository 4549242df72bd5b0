"""A smooth closed outline of circular arcs: lobes side by side, each valley between two a fillet.

A lobe is a circle or an oval of four arcs that meet at 45 degrees: with half axes a along X and b
along Y, and k = (b - a) / (2 - sqrt 2), its sides have the radius a + k and its ends b - k. Going
around, one lobe is left for the next over a concave arc, whose circle touches both from outside.

Moved inward by w along its normal the outline stays one of arcs about the same centres: convex
radii less w, concave ones more. With an arc's centre c, ends p and q, radius r and turn t, positive
where convex,

    area = sum of (c x (q - p) + r^2 t) / 2,     perimeter = sum of r |t|,

and the distance to the outline is exact. Leaves out: straight pieces.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np

OVAL = 2.0 - math.sqrt(2.0)
LEAST_TURN = 1e-7
"""Turn of an arc below which it is none [rad]: its ends are one place to the CAD kernel."""
SHORTEST_MM = 0.05
"""Arc of a lobe or a valley that is too short to be one [mm]."""
BETWEEN = 5
"""Places looked at on each arc for arcs that cross."""


class Piece(NamedTuple):
    """An arc of a lobe, counter-clockwise."""

    x_mm: float
    y_mm: float
    radius_mm: float
    start_rad: float
    turn_rad: float


@dataclass(frozen=True, kw_only=True, slots=True)
class Lobe:
    """A round or oval lobe of an outline."""

    x_mm: float
    y_mm: float
    half_mm: tuple[float, float]
    """Half axes along X and Y [mm]."""

    @property
    def bend_mm(self) -> float:
        """Radius where it is narrowest; not positive where it is too long to be of arcs."""
        short, long = sorted(self.half_mm)
        return long - (long - short) / OVAL

    def pieces(self) -> list[Piece]:
        """Its arcs, from the one about +X on; a circle is one piece."""
        (x, y), (a, b) = (self.x_mm, self.y_mm), self.half_mm
        more = (b - a) / OVAL
        if abs(more) < LEAST_TURN:
            return [Piece(x, y, a, 0.0, 2.0 * math.pi)]
        side, end, quarter = a + more, b - more, math.pi / 2.0
        return [
            Piece(x - more, y, side, -quarter / 2, quarter),
            Piece(x, y + more, end, quarter / 2, quarter),
            Piece(x + more, y, side, 3 * quarter / 2, quarter),
            Piece(x, y - more, end, 5 * quarter / 2, quarter),
        ]


@dataclass(frozen=True, kw_only=True, slots=True)
class Arcs:
    """An outline of K arcs, counter-clockwise from above."""

    centres_mm: np.ndarray
    """Shape (K, 2)."""
    radii_mm: np.ndarray
    """Shape (K,)."""
    starts_rad: np.ndarray
    """Azimuth of each arc's start about its centre, shape (K,)."""
    turns_rad: np.ndarray
    """How far each goes from there, shape (K,): positive on a lobe, negative in a valley."""

    @property
    def convex(self) -> np.ndarray:
        """Which arcs are lobes, shape (K,), bool."""
        return self.turns_rad > 0.0

    @property
    def bend_mm(self) -> float:
        """Radius of the narrowest lobe."""
        return float(self.radii_mm[self.convex].min())

    @property
    def area_mm2(self) -> float:
        """Area inside; see the module docstring."""
        start, stop = self.spots_mm(0.0), self.spots_mm(1.0)
        chord, centre = stop - start, self.centres_mm
        about = centre[:, 0] * chord[:, 1] - centre[:, 1] * chord[:, 0]
        return float((about + self.radii_mm**2 * self.turns_rad).sum()) / 2.0

    @property
    def perimeter_mm(self) -> float:
        """Length around."""
        return float((self.radii_mm * np.abs(self.turns_rad)).sum())

    @property
    def points_mm(self) -> np.ndarray:
        """Places on all arcs in order, shape (K * BETWEEN, 2)."""
        shares = np.arange(BETWEEN) / BETWEEN
        return np.stack([self.spots_mm(share) for share in shares], axis=1).reshape(-1, 2)

    def spots_mm(self, share: float) -> np.ndarray:
        """The place on each arc at a share of its turn, shape (K, 2)."""
        turn = self.starts_rad + share * self.turns_rad
        return self.centres_mm + self.radii_mm[:, None] * np.column_stack(
            [np.cos(turn), np.sin(turn)]
        )

    def inset(self, wall_mm: float) -> Arcs | None:
        """The outline moved inward by a wall; None where a lobe is narrower or it meets itself."""
        radii_mm = self.radii_mm - np.where(self.convex, wall_mm, -wall_mm)
        found = replace(self, radii_mm=radii_mm)
        return found if radii_mm.min() > SHORTEST_MM and _simple(found.points_mm) else None

    def distance(self, points_mm: np.ndarray) -> np.ndarray:
        """Signed distance in plan, exact, shape (N,); points of shape (N, 2 or more)."""
        nearest = np.full(len(points_mm), np.inf)
        signed = np.empty(len(points_mm))
        ends_mm = self.spots_mm(0.0)
        for k, turn in enumerate(self.turns_rad):
            x, y = (points_mm[:, axis] - self.centres_mm[k, axis] for axis in (0, 1))
            side = math.copysign(1.0, turn)
            beside = side * (np.hypot(x, y) - self.radii_mm[k])
            past = (side * (np.arctan2(y, x) - self.starts_rad[k])) % (2.0 * np.pi)
            away = np.where(past <= abs(turn), np.abs(beside), np.inf)
            # Arcs share ends and tangents there, so the start of each is looked at once.
            end = np.hypot(points_mm[:, 0] - ends_mm[k, 0], points_mm[:, 1] - ends_mm[k, 1])
            away = np.minimum(away, end)
            closer = away < nearest
            nearest[closer] = away[closer]
            signed[closer] = np.copysign(away[closer], beside[closer])
        return signed

    def edges(self, height_mm: float = 0.0) -> list[Any]:
        """The arcs as build123d edges at a height."""
        from build123d import Edge

        shares = (self.spots_mm(share).tolist() for share in (0.0, 0.5, 1.0))
        starts, middles, _ = shares
        stops = [*starts[1:], starts[0]]
        return [
            Edge.make_three_point_arc(*((*spot, height_mm) for spot in spots))
            for spots in zip(starts, middles, stops, strict=True)
        ]


def around(lobes: Sequence[Lobe], valley_mm: float) -> Arcs | None:
    """The outline about lobes in counter-clockwise order; None where they make none.

    That is where neighbours are too far apart for a valley of that radius, where valleys leave
    nothing of a lobe, or where the outline would cross itself.
    """
    pieces = [lobe.pieces() for lobe in lobes]
    valleys = [
        _valley(here, there, valley_mm)
        for here, there in zip(pieces, [*pieces[1:], pieces[0]], strict=True)
    ]
    arcs: list[Piece] = []
    for number, own in enumerate(pieces):
        before, after = valleys[number - 1], valleys[number]
        if before is None or after is None:
            return None
        walk = _walk(own, before.reached, after.left)
        if sum(piece.turn_rad * piece.radius_mm for piece in walk) < SHORTEST_MM:
            return None
        arcs += [*walk, after.arc]
    found = Arcs(
        centres_mm=np.array([arc[:2] for arc in arcs]),
        radii_mm=np.array([arc.radius_mm for arc in arcs]),
        starts_rad=np.array([arc.start_rad for arc in arcs]),
        turns_rad=np.array([arc.turn_rad for arc in arcs]),
    )
    once = abs(float(found.turns_rad.sum()) - 2.0 * math.pi) < 1e-6
    return found if once and _simple(found.points_mm) else None


class _Valley(NamedTuple):
    arc: Piece
    left: tuple[int, float]
    """Piece of the lobe before it, and how far along that [rad]."""
    reached: tuple[int, float]
    """Piece of the lobe after it, and how far along that [rad]."""


def _valley(here: list[Piece], there: list[Piece], radius_mm: float) -> _Valley | None:
    """The arc that touches two lobes from outside; None where there is none."""
    for (first, p), (second, q) in itertools.product(enumerate(here), enumerate(there)):
        near, far = p.radius_mm + radius_mm, q.radius_mm + radius_mm
        way = q.x_mm - p.x_mm, q.y_mm - p.y_mm
        apart = math.hypot(*way)
        if not abs(near - far) < apart < near + far:
            continue
        along = (apart**2 + near**2 - far**2) / (2.0 * apart)
        beside = math.sqrt(near**2 - along**2)
        x = p.x_mm + (along * way[0] + beside * way[1]) / apart
        y = p.y_mm + (along * way[1] - beside * way[0]) / apart
        leave, reach = math.atan2(y - p.y_mm, x - p.x_mm), math.atan2(y - q.y_mm, x - q.x_mm)
        left, reached = ((a - c.start_rad) % (2.0 * math.pi) for a, c in ((leave, p), (reach, q)))
        turn = -((leave - reach) % (2.0 * math.pi))
        if left <= p.turn_rad and reached <= q.turn_rad and -turn * radius_mm > SHORTEST_MM:
            arc = Piece(x, y, radius_mm, leave + math.pi, turn)
            return _Valley(arc, (first, left), (second, reached))
    return None


def _walk(pieces: list[Piece], start: tuple[int, float], stop: tuple[int, float]) -> list[Piece]:
    """The arcs of a lobe between two places on it, counter-clockwise."""
    (number, begun), (last, end) = start, stop
    found: list[Piece] = []
    while number != last or end < begun:
        piece = pieces[number]
        found.append(_part(piece, begun, piece.turn_rad))
        number, begun = (number + 1) % len(pieces), 0.0
    found.append(_part(pieces[last], begun, end))
    return [piece for piece in found if piece.turn_rad > LEAST_TURN]


def _part(piece: Piece, begun: float, end: float) -> Piece:
    return piece._replace(start_rad=piece.start_rad + begun, turn_rad=end - begun)


def _simple(points_mm: np.ndarray) -> bool:
    """Whether no two sides of a polygon cross; points of shape (N, 2)."""
    start, side = points_mm, np.roll(points_mm, -1, axis=0) - points_mm
    gap = start[None, :, :] - start[:, None, :]
    cross = side[:, None, 0] * side[None, :, 1] - side[:, None, 1] * side[None, :, 0]
    with np.errstate(divide="ignore", invalid="ignore"):
        first = (gap[..., 0] * side[None, :, 1] - gap[..., 1] * side[None, :, 0]) / cross
        second = (gap[..., 0] * side[:, None, 1] - gap[..., 1] * side[:, None, 0]) / cross
        met = (first > 0.0) & (first < 1.0) & (second > 0.0) & (second < 1.0)
    number = np.arange(len(points_mm))
    apart = np.abs(number[:, None] - number[None, :]) % (len(number) - 1) > 1
    return not bool((met & apart).any())
