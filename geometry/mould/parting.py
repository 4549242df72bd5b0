"""Where the outer mould is parted: how many parts, which way they are pulled, which surface.

Two parts meet on the ruled surface x = c(z), with x along the pull of the first: c follows the
places where the body's sections are widest across the pull, as a cubic in z, and is flat where that
moves by less than half a millimetre. Three or four parts meet on half planes through the middle,
evenly turned. Every azimuth in steps of 7.5 degrees is tried; its undercut is the share of the
surface that rays along each part's pull find blocked.

More parts are made only if they lower the undercut to half or less, and by at least one per cent of
the surface: each further part costs a print, a seam and bolts.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from geometry.body.csg import turn_z
from geometry.body.csg_mesh import evaluate
from geometry.mould.cast import Cast
from geometry.mould.castability import blocked
from geometry.surface.rays import RayCaster
from geometry.surface.spread import Spread, spread

STEP_DEG = 7.5
FLAT_MM = 0.5
"""A parting surface that bends by less is flat [mm]."""
SECTIONS = 24
CURVE_POINTS = 25
COUNTS = (2, 3, 4)
WORTH_SHARE = 0.5
WORTH_AREA = 0.01
SAMPLES = 1500
WIDEST_SHARE = 0.01
"""Points within this share of a section's width from its end tell where it is widest."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Parting:
    """How the outer mould falls into parts; local frame: x along the first part's pull."""

    count: int
    azimuth_deg: float
    """Azimuth of the first part's pull."""
    middle_mm: np.ndarray
    """Axis in the local frame, shape (2,)."""
    curve_mm: np.ndarray
    """x and z of the parting surface of two parts, local frame, rising z, shape (P, 2)."""
    undercut: float
    """Share of the sensing surface that is blocked, all parts together."""

    @property
    def names(self) -> tuple[str, ...]:
        """`half_a` and `half_b`, or `part_a` to `part_d`."""
        kind = "half" if self.count == 2 else "part"
        return tuple(f"{kind}_{letter}" for letter in "abcd"[: self.count])

    @property
    def pulls(self) -> np.ndarray:
        """Unit pull direction of each part in the sensor frame, shape (K, 3)."""
        turns = np.radians(self.azimuth_deg + 360.0 * np.arange(self.count) / self.count)
        return np.column_stack([np.cos(turns), np.sin(turns), np.zeros(self.count)])

    def part_of(self, points_mm: np.ndarray) -> np.ndarray:
        """Number of the part at each point of the sensor frame, shape (N,), from (N, 3)."""
        local = points_mm @ turn_z(self.azimuth_deg)
        if self.count == 2:
            return (local[:, 0] < self.curve_x_mm(local[:, 2])).astype(int)
        offset = local[:, :2] - self.middle_mm
        turn = np.degrees(np.arctan2(offset[:, 1], offset[:, 0]))
        return np.rint(turn / (360.0 / self.count)).astype(int) % self.count

    def curve_x_mm(self, z_mm: np.ndarray | float) -> np.ndarray:
        """Where two parts meet at a height [mm]."""
        return np.asarray(np.interp(z_mm, self.curve_mm[:, 1], self.curve_mm[:, 0]))


def ranked_partings(cast: Cast, counts: Sequence[int]) -> list[Parting]:
    """Partings into these numbers of parts, given rising, the one to take first.

    After it those to try where its parts cannot be taken apart: the best of each other number, and
    then of each the least undercut at least an eighth of a turn from its best.
    """
    places = spread(cast.sensing.points_mm, cast.sensing.faces, SAMPLES)
    caster = RayCaster(cast.outer.points_mm, cast.outer.faces)
    sections = _sections(cast)
    chosen, others = None, []
    for count in counts:
        turns = np.arange(0.0, 180.0 if count == 2 else 360.0 / count, STEP_DEG)
        tried = [_scored(cast, sections, count, turn, places, caster) for turn in turns]
        best = min(tried, key=_blocked)
        if chosen is None or _worth(chosen.undercut, best.undercut):
            chosen = best
        others += [best, *sorted((p for p in tried if _aside(p, best)), key=_blocked)[:1]]
    assert chosen is not None  # counts is never empty
    return [chosen, *sorted((p for p in others if p is not chosen), key=_blocked)]


def _blocked(parting: Parting) -> float:
    # Rounded, so that the first of equally good azimuths wins over one better by noise.
    return round(parting.undercut, 3)


def _aside(parting: Parting, other: Parting) -> bool:
    """Whether two partings into as many parts lie an eighth of their period apart or more."""
    period = 360.0 / parting.count
    apart = abs(parting.azimuth_deg - other.azimuth_deg) % period
    return min(apart, period - apart) >= period / 8.0


def _worth(fewer: float, more: float) -> bool:
    return more <= WORTH_SHARE * fewer and fewer - more >= WORTH_AREA


def _scored(
    cast: Cast,
    sections: list[np.ndarray],
    count: int,
    azimuth_deg: float,
    places: Spread,
    caster: RayCaster,
) -> Parting:
    rotation = turn_z(azimuth_deg)
    local = cast.outer.points_mm @ rotation
    middle = (local.min(axis=0) + local.max(axis=0))[:2] / 2
    curve = _curve([points @ rotation for points in sections], local, middle)
    fields: dict[str, Any] = {
        "count": count,
        "azimuth_deg": float(azimuth_deg),
        "middle_mm": middle,
        "curve_mm": curve,
    }
    parting = Parting(**fields, undercut=0.0)
    pulls = parting.pulls[parting.part_of(places.points_mm)]
    return Parting(**fields, undercut=float(blocked(places, pulls, caster).mean()))


def _sections(cast: Cast) -> list[np.ndarray]:
    """Outlines of the outer body at rising heights, each (N, 3)."""
    body = evaluate(cast.outer)
    low, high = cast.corners_mm
    span = high[2] - low[2]
    heights = low[2] + span * (np.arange(SECTIONS) + 0.5) / SECTIONS
    found = []
    for height in heights:
        outlines = body.slice(float(height)).to_polygons()
        if outlines:
            points = np.concatenate([np.asarray(outline) for outline in outlines])
            found.append(np.column_stack([points, np.full(len(points), height)]))
    return found


def _curve(sections: list[np.ndarray], local: np.ndarray, middle: np.ndarray) -> np.ndarray:
    """x and z of the parting surface, shape (P, 2)."""
    low, high = float(local[:, 2].min()), float(local[:, 2].max())
    where = np.array([[_widest_x(points), points[0, 2]] for points in sections])
    flat = np.array([[middle[0], low], [middle[0], high]])
    if len(where) < 8:
        return flat
    fit = np.polynomial.Polynomial.fit(where[:, 1], where[:, 0], 3)
    heights = np.linspace(low, high, CURVE_POINTS)
    # Only between the sections: a cubic runs away beyond its data.
    across = fit(np.clip(heights, where[0, 1], where[-1, 1]))
    if np.abs(across - middle[0]).max() < FLAT_MM:
        return flat
    return np.column_stack([across, heights])


def _widest_x(points: np.ndarray) -> float:
    """Mean x of both ends of a section across the pull."""
    across = points[:, 1]
    reach = WIDEST_SHARE * np.ptp(across)
    ends = (across <= across.min() + reach), (across >= across.max() - reach)
    return float(np.mean([(points[end, 0].min() + points[end, 0].max()) / 2 for end in ends]))
