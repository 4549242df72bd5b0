"""Normand SK6812RGBW-BW: red, green, blue and white with their driver in one body."""

from __future__ import annotations

from workbench.core.catalogue.led_part import LedPart

LED = LedPart(
    title="Normand SK6812RGBW-BW",
    source="https://dokumen.tips/documents/sk6812rgbw-bw-datasheetpdf-bw-b7000-8300k-bw-c6000-7000k-r-10-20-a-50-power.html",
    light=("red", "green", "blue", "white"),
    width_mm=5.4,
    height_mm=5.0,
    thick_mm=1.6,
    view_deg=120.0,
)
