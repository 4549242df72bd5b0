"""Worldsemi WS2812B-2020: red, green and blue with their driver in one body."""

from __future__ import annotations

from workbench.core.catalogue.led_part import LedPart

LED = LedPart(
    title="Worldsemi WS2812B-2020",
    source="https://sheetsdata.com/parts/WS2812B-2020",
    light=("red", "green", "blue"),
    dominant_nm=(622.6, 515.6, 470.4),
    intensity_mcd=(200.0, 600.0, 160.0),
    current_mA=12.0,
)
