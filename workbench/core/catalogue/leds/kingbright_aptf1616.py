"""Kingbright APTF1616LSEKJ3ZGKQBC: red, green and blue in one body of 1.6 mm."""

from __future__ import annotations

from workbench.core.catalogue.led_part import LedPart

LED = LedPart(
    title="Kingbright APTF1616LSEKJ3ZGKQBC",
    source="https://www.scribd.com/document/892348974/APTF1616LSEKJ3ZGKQBC",
    light=("red", "green", "blue"),
    width_mm=1.6,
    height_mm=1.6,
    thick_mm=0.7,
    peak_nm=(640.0, 515.0, 460.0),
    dominant_nm=(625.0, 525.0, 465.0),
    band_nm=(20.0, 35.0, 25.0),
    current_mA=2.0,
)
