"""Light, housing and parts list put the LEDs in the same places."""

from __future__ import annotations

import numpy as np
import pytest

from geometry.housing.leds import led_items
from sim.optics.light.lights import place_leds
from sim.optics.light.spectrum import linear_rgb
from workbench.core.design.leds import led_places
from workbench.core.design.lighting import LedRing

RINGS = (
    LedRing(),
    LedRing(count=7, radius_mm=5.5, height_mm=2.25, phase_deg=-35.0, tilt_deg=-60.0),
    LedRing(count=5, phase_deg=123.4, tilt_deg=40.0, colours=("#ff0000", "#0000ff")),
)


@pytest.mark.parametrize("ring", RINGS)
def test_light_and_parts_list_agree(ring: LedRing) -> None:
    """Same place, axis and colour for each LED, to the nanometre of the list."""
    leds, items = place_leds(ring), led_items(ring)
    assert [item.number for item in items] == list(range(1, ring.count + 1))
    for number, item in enumerate(items):
        assert item.position_mm == pytest.approx(leds.position_mm[number], abs=1e-6)
        assert item.axis == pytest.approx(leds.axis[number], abs=1e-6)
        assert linear_rgb(item.colour) == pytest.approx(leds.rgb[number])


def test_an_led_by_hand() -> None:
    """Second of four, phase 30: 120 degrees at radius 8 is (-4, 6.9282, 1); tilted 90, outward."""
    ring = LedRing(count=4, radius_mm=8.0, height_mm=1.0, phase_deg=30.0, tilt_deg=90.0)
    places, axes = led_places(ring)
    assert places[1] == pytest.approx((-4.0, 8.0 * np.sqrt(0.75), 1.0))
    assert axes[1] == pytest.approx((-0.5, np.sqrt(0.75), 0.0), abs=1e-12)
