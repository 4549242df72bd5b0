"""Whether a mould can be made and opened: measures on triangle meshes.

Each is a number with the place where it is worst, so that a designer can be shown it. Limits and
words are in `mould_checks`. Surfaces are looked at in evenly spread places (a low-discrepancy
sequence, so the answer is the same each time), and things in the way are found by rays.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from geometry.surface.rays import RayCaster
from geometry.surface.spread import Spread

LIFT_MM = 0.1
"""Undercuts shallower than this are none: the silicone gives way [mm]."""
STEEPEST_SHARE = 0.01
"""The least draft is that of the worst hundredth of the area; single facets are noise."""
NARROW_MM = 1e-3


class Worst(NamedTuple):
    """A measure and the place where it is worst."""

    value: float
    place_mm: tuple[float, float, float]


def blocked(places: Spread, pulls: np.ndarray, caster: RayCaster) -> np.ndarray:
    """Which places of a cast its mould cannot leave along the pull, shape (S,), bool.

    The mould's surface is lifted off the cast by `LIFT_MM` and then moves along its pull; where it
    meets the cast it is held. Facets that only lean against the pull so count if it matters.

    Args:
        pulls: Direction of the mould part at each place, shape (S, 3).
        caster: Rays against the whole cast.
    """
    start = places.points_mm + LIFT_MM * places.normals
    return caster.occluded(start, pulls, np.inf)


def undercut(points_mm: np.ndarray, faces: np.ndarray, pull: np.ndarray, part: Spread) -> Worst:
    """Share of a region that holds its mould part when that is pulled, and the worst place.

    Args:
        points_mm: Vertices of the cast, shape (N, 3).
        faces: Triangles of the whole cast, shape (M, 3).
        pull: Unit direction of the part.
        part: Places on the region that the part shapes.
    """
    if not len(part.points_mm):
        return Worst(0.0, (0.0, 0.0, 0.0))
    held = blocked(part, np.tile(pull, (len(part.points_mm), 1)), RayCaster(points_mm, faces))
    if not held.any():
        return Worst(0.0, _place(part.points_mm[np.argmin(part.normals @ pull)]))
    rows = np.flatnonzero(held)
    worst = rows[np.argmin(part.normals[rows] @ pull)]
    return Worst(float(held.mean()), _place(part.points_mm[worst]))


def draft_deg(part: Spread, pull: np.ndarray) -> Worst:
    """Least angle between the pull and the surface [degree]; negative where it leans against it.

    0 on a cylinder pulled along its axis, the half angle on a cone, 90 on a flat end.
    """
    if not len(part.points_mm):
        return Worst(90.0, (0.0, 0.0, 0.0))
    angle = np.degrees(np.arcsin(np.clip(part.normals @ pull, -1.0, 1.0)))
    order = np.argsort(angle)
    worst = order[int(STEEPEST_SHARE * (len(order) - 1))]
    return Worst(float(angle[worst]), _place(part.points_mm[worst]))


def bed_ratio(points_mm: np.ndarray, bed_mm: tuple[float, float, float]) -> float:
    """Largest size over the room for it, in the best of the six orientations along the axes.

    Sorted sizes against sorted rooms are the best of them.
    """
    size = np.sort(np.ptp(points_mm, axis=0))
    return float((size / np.sort(np.asarray(bed_mm))).max())


def removal_strain(heights_mm: np.ndarray, around_mm: np.ndarray) -> Worst:
    """Strain that the elastomer must bear for a core to leave downward through it.

    max over z of (circumference at z) / (least circumference below z) - 1.

    Args:
        heights_mm: Rising heights of sections, shape (H,).
        around_mm: Circumference of the core there, shape (H,).
    """
    below = np.minimum.accumulate(np.maximum(around_mm, NARROW_MM))
    strain = around_mm / below - 1.0
    worst = int(np.argmax(strain))
    return Worst(max(0.0, float(strain[worst])), (0.0, 0.0, float(heights_mm[worst])))


def _place(point: np.ndarray) -> tuple[float, float, float]:
    return float(point[0]), float(point[1]), float(point[2])
