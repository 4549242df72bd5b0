"""Where the LEDs of a ring sit, for the parts that hold them and the list of what to solder.

The same circle as the light model's: evenly spaced about +Z, tilted outward from +Z, colours in
equal sectors in the order of azimuth. Leaves out: LEDs that are not on a ring.
"""

from __future__ import annotations

import numpy as np

from workbench.core.design import LedRing
from workbench.core.fabrication import LedItem


def led_places(ring: LedRing) -> tuple[np.ndarray, np.ndarray]:
    """Positions [mm] and unit emission axes of the LEDs, shape (L, 3) each."""
    azimuth = np.radians(ring.phase_deg + 360.0 * np.arange(ring.count) / ring.count)
    outward = np.column_stack([np.cos(azimuth), np.sin(azimuth), np.zeros(ring.count)])
    up = np.array([0.0, 0.0, 1.0])
    tilt = np.radians(ring.tilt_deg)
    places = ring.radius_mm * outward + ring.height_mm * up
    return places, np.cos(tilt) * up + np.sin(tilt) * outward


def led_items(ring: LedRing) -> tuple[LedItem, ...]:
    """The LEDs as rows of the bill of materials, numbered from 1."""
    places, axes = led_places(ring)
    return tuple(
        LedItem(
            number=number + 1,
            colour=ring.colours[number * len(ring.colours) // ring.count],
            position_mm=_triple(places[number]),
            axis=_triple(axes[number]),
        )
        for number in range(ring.count)
    )


def _triple(values: np.ndarray) -> tuple[float, float, float]:
    # Rounded to a nanometre: -1e-16 on a build sheet is not a position.
    x, y, z = (round(float(value), 6) + 0.0 for value in values)
    return x, y, z
