"""Kingbright KP-1608PBC: blue, 0603, water clear."""

from __future__ import annotations

from workbench.core.catalogue.led_part import LedPart

LED = LedPart(
    title="Kingbright KP-1608PBC",
    source="https://pdf.product.network/abbfeb56/kingbright.com/KP-1608PBC-A.html",
    light=("blue",),
    width_mm=1.6,
    height_mm=0.8,
    thick_mm=1.1,
    view_deg=120.0,
    peak_nm=(468.0,),
    dominant_nm=(470.0,),
    band_nm=(25.0,),
    intensity_mcd=(45.0,),
    current_mA=20.0,
)
