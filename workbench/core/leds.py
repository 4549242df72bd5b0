"""Where the LEDs of a ring sit: the one circle that light, housing and parts list share.

p_k = r (cos a_k, sin a_k, 0) + h z with a_k = phase + k 360 / count; the emission axis is +Z tilted
outward. Leaves out: LEDs that are not on a ring; `colour_sectors` says which has which colour.
"""

from __future__ import annotations

import numpy as np

from workbench.core.lighting import LedRing
from workbench.core.units import radians


def led_places(ring: LedRing) -> tuple[np.ndarray, np.ndarray]:
    """Positions [mm] and unit emission axes of the LEDs, shape (L, 3) each, float64."""
    azimuth = radians(ring.phase_deg) + np.arange(ring.count) * (2 * np.pi / max(ring.count, 1))
    outward = np.column_stack([np.cos(azimuth), np.sin(azimuth), np.zeros(ring.count)])
    up = np.array([0.0, 0.0, 1.0])
    tilt = radians(ring.tilt_deg)
    places = ring.radius_mm * outward + ring.height_mm * up
    return places, np.cos(tilt) * up + np.sin(tilt) * outward


def colour_sectors(ring: LedRing) -> np.ndarray:
    """Row of `ring.colours` of each LED, shape (L,): equal sectors in the order of azimuth."""
    return np.arange(ring.count) * len(ring.colours) // max(ring.count, 1)
