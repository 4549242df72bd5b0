"""Room that the LEDs of a ring take, and the outline of what holds them."""

from __future__ import annotations

import numpy as np

from geometry.body import csg
from geometry.housing.led_holder import LEAST_WALL_MM, SPARE_MM
from workbench.core.design.leds import led_places
from workbench.core.design.lighting import LedRing
from workbench.core.design.making import Housing

LED_DEPTH_MM = 0.8
"""Height of an LED with its solder. Source: WS2812 packages are 0.5 to 0.7 mm high."""
FLOOR_MM = 1.2
"""Material under the LEDs: three layers of a resin print or a flexible circuit [mm]."""


def led_rooms(ring: LedRing, options: Housing, gap_mm: float) -> tuple[csg.Node, ...]:
    """Room of each LED behind its emitting face; with a gap, a pocket open to the front."""
    x, y = options.led_width_mm / 2 + gap_mm, options.led_height_mm / 2 + gap_mm
    front = options.wall_mm if gap_mm else 0.0
    box = csg.Box(low_mm=(-x, -y, -LED_DEPTH_MM), high_mm=(x, y, front))
    found = []
    for place, axis in zip(*led_places(ring), strict=True):
        outward = np.array([place[0], place[1], 0.0])
        if not outward.any():
            found.append(csg.along(box, axis, place))
            continue
        around = np.cross([0.0, 0.0, 1.0], outward / np.linalg.norm(outward))
        frame = np.column_stack([np.cross(around, axis), around, axis, place])
        found.append(csg.Placed(body=box, matrix=frame))
    return tuple(found)


def ring_outline(ring: LedRing, options: Housing, gap_mm: float) -> csg.Node:
    """Outline of the LEDs' ring; with a gap, its seat."""
    top = ring.height_mm + gap_mm
    low = ring.height_mm - holder_mm(ring, options) - gap_mm
    disc = csg.cylinder(ring.radius_mm + half_mm(options) + gap_mm, low, top)
    hole = hole_mm(ring, options, gap_mm)
    if hole <= 0.0:
        return disc
    return csg.without(disc, [csg.cylinder(hole, low - 1.0, top + 1.0)])


def holder_mm(ring: LedRing, options: Housing) -> float:
    """Height of the LEDs' holder: enough for a wall below the pockets of tilted LEDs.

    The lowest corner of an LED of width w tilted by t is sin t (w / 2 + gap) + cos t depth below.
    """
    tilt = np.radians(min(abs(ring.tilt_deg), 90.0))
    beside = options.led_width_mm / 2 + options.clearance_mm
    corner = np.sin(tilt) * beside + np.cos(tilt) * LED_DEPTH_MM
    return max(LED_DEPTH_MM + FLOOR_MM, float(corner) + LEAST_WALL_MM + SPARE_MM)


def half_mm(options: Housing) -> float:
    """Half the width of the LEDs' ring."""
    return max(options.led_width_mm, options.led_height_mm) / 2 + options.wall_mm


def hole_mm(ring: LedRing, options: Housing, gap_mm: float = 0.0) -> float:
    """Radius of the hole of the LEDs' ring; 0 where it is too small to be made."""
    hole = ring.radius_mm - half_mm(options) - gap_mm
    return 0.0 if hole <= options.wall_mm else hole
