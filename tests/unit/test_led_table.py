"""Single LEDs of a ring: colour and power of one leave the others as they are."""

from __future__ import annotations

import dataclasses

import pytest

from workbench.core.base.errors import DesignError
from workbench.core.design.lighting import LedRing
from workbench.edit.item_fields import with_field
from workbench.edit.led_table import factors_of, leds_of, with_colour, with_count, with_factor
from workbench.project.named_designs import load_design

RING = LedRing(count=6, radius_mm=5.0, height_mm=2.0, phase_deg=0.0)


def test_leds_are_listed_with_place_and_sector() -> None:
    """LED 1 at azimuth 0, LED 4 opposite; two of each of three colours."""
    leds = leds_of(RING)
    assert leds[0].place_mm == pytest.approx((5.0, 0.0, 2.0))
    assert leds[3].place_mm == pytest.approx((-5.0, 0.0, 2.0))
    assert [led.colour for led in leds] == ["#ff0000"] * 2 + ["#00ff00"] * 2 + ["#0000ff"] * 2


def test_one_factor_is_kept_and_taken_back() -> None:
    """Factor .5 on LED 2 alone; 1 again leaves the ring as it was."""
    dimmed = with_factor(RING, 2, 0.5)
    assert factors_of(dimmed) == (1.0, 0.5, 1.0, 1.0, 1.0, 1.0)
    assert with_factor(dimmed, 2, 1.0) == RING


def test_one_colour_leaves_the_others() -> None:
    """LED 3 white: the five others keep their sector's colour."""
    before = [led.colour for led in leds_of(RING)]
    after = [led.colour for led in leds_of(with_colour(RING, 3, "#ffffff"))]
    assert after == [*before[:2], "#ffffff", *before[3:]]
    with pytest.raises(DesignError):
        with_colour(RING, 3, "<b>")


@pytest.mark.parametrize(
    ("count", "expected"), [(3, (1.0, 0.5, 1.0)), (7, (1.0, 0.5) + (1.0,) * 5)]
)
def test_factors_follow_the_number_of_leds(count: int, expected: tuple[float, ...]) -> None:
    """Through the path that the slider edits, too; a refused count is told as a count."""
    dimmed = with_factor(RING, 2, 0.5)
    assert factors_of(with_count(dimmed, count)) == expected
    design = load_design("geltip")
    optics = dataclasses.replace(design.optics, ring=dimmed)
    design = dataclasses.replace(design, optics=optics)
    changed = with_field(design, "optics.ring.count", count)
    assert factors_of(changed.optics.ring) == expected
    with pytest.raises(DesignError) as caught:
        with_field(design, "optics.ring.count", 65)
    assert caught.value.at == "optics.ring.count"
