"""Kingbright APTR3216QWF/D: white, 1206, with a yellow phosphor."""

from __future__ import annotations

from workbench.core.catalogue.led_part import LedPart

LED = LedPart(
    title="Kingbright APTR3216QWF/D",
    source="https://dtsheet.com/doc/2815205/kingbright-aptr3216qwf-d-3.2x1.6mm-smd-chip-led-lamp-data...",
    light=("white",),
    width_mm=3.2,
    height_mm=1.6,
    thick_mm=1.05,
    view_deg=120.0,
    chromaticity=(0.31, 0.31),
    intensity_mcd=(250.0,),
    current_mA=20.0,
)
