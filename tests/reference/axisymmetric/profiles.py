"""Rigid objects of revolution by the signed distance to their section.

Places are (r, z) [mm] from the object's lowest point, z away from the skin. The distance's second
derivatives are kappa t t^T, t the direction along the profile.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, kw_only=True, slots=True)
class Near:
    """What the object's surface is like near places, Q of them."""

    distance_mm: np.ndarray
    """Negative inside, shape (Q,)."""
    normal: np.ndarray
    """Away from the object, shape (Q, 2)."""
    curvature_per_mm: np.ndarray
    """kappa, shape (Q,)."""

    @property
    def along(self) -> np.ndarray:
        """t: the normal turned by a right angle, shape (Q, 2)."""
        return np.stack([-self.normal[:, 1], self.normal[:, 0]], axis=1)


Profile = Callable[[np.ndarray], Near]


def ball(radius_mm: float) -> Profile:
    """A sphere: phi = |x - c| - R."""

    def near(places_mm: np.ndarray) -> Near:
        away = places_mm - [0.0, radius_mm]
        length = np.linalg.norm(away, axis=1)
        return Near(
            distance_mm=length - radius_mm,
            normal=away / length[:, None],
            curvature_per_mm=1.0 / length,
        )

    return near


def torus(ring_mm: float, tube_mm: float, dome_mm: float) -> Profile:
    """A ring that lies flat, counted from where it first touches a dome of radius `dome_mm`.

    Its lowest points are then sqrt((dome + tube)^2 - ring^2) - tube over the dome's centre.
    """
    tube = ball(tube_mm)
    sunk_mm = dome_mm - (math.sqrt((dome_mm + tube_mm) ** 2 - ring_mm**2) - tube_mm)

    def near(places_mm: np.ndarray) -> Near:
        return tube(places_mm + np.array([-ring_mm, sunk_mm]))

    return near


def cone(half_angle_deg: float, tip_mm: float) -> Profile:
    """A cone without a base whose apex is a sphere of radius `tip_mm` that touches its flank."""
    angle = math.radians(half_angle_deg)
    outward = np.array([math.cos(angle), -math.sin(angle)])
    upward = np.array([math.sin(angle), math.cos(angle)])
    apex = ball(tip_mm)

    def near(places_mm: np.ndarray) -> Near:
        away = places_mm - [0.0, tip_mm]
        flank = away @ upward > 0.0
        round_ = apex(places_mm)
        return Near(
            distance_mm=np.where(flank, away @ outward - tip_mm, round_.distance_mm),
            normal=np.where(flank[:, None], outward, round_.normal),
            curvature_per_mm=np.where(flank, 0.0, round_.curvature_per_mm),
        )

    return near
