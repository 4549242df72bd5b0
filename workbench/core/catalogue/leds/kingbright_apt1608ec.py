"""Kingbright APT1608EC: red, 0603, water clear."""

from __future__ import annotations

from workbench.core.catalogue.led_part import LedPart

LED = LedPart(
    title="Kingbright APT1608EC",
    source="https://scribd.com/document/718036880/APT1608EC",
    light=("red",),
    width_mm=1.6,
    height_mm=0.8,
    thick_mm=0.75,
    view_deg=150.0,
    peak_nm=(627.0,),
    dominant_nm=(617.0,),
    band_nm=(45.0,),
    intensity_mcd=(15.0,),
    current_mA=20.0,
)
