"""The LEDs of a ring as the list of what to solder, in the order of azimuth."""

from __future__ import annotations

import numpy as np

from workbench.core.design.leds import colour_sectors, led_places
from workbench.core.design.lighting import LedRing
from workbench.core.result.fabrication import LedItem


def led_items(ring: LedRing) -> tuple[LedItem, ...]:
    """The LEDs as rows of the bill of materials, numbered from 1."""
    places, axes = led_places(ring)
    sectors = colour_sectors(ring)
    return tuple(
        LedItem(
            number=number + 1,
            colour=ring.colours[sectors[number]],
            position_mm=_triple(places[number]),
            axis=_triple(axes[number]),
        )
        for number in range(ring.count)
    )


def _triple(values: np.ndarray) -> tuple[float, float, float]:
    # Rounded to a nanometre: -1e-16 on a build sheet is not a position.
    x, y, z = (round(float(value), 6) + 0.0 for value in values)
    return x, y, z
