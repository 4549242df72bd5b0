"""Everlight 19-213SUBC: blue, 0603, 0.6 mm high."""

from __future__ import annotations

from workbench.core.catalogue.led_part import LedPart

LED = LedPart(
    title="Everlight 19-213SUBC/S400-A5/S208-2/TR8",
    source="https://pdf.product.live/c1ba10cf/3m.com/3625%2F3030%20M.txt",
    light=("blue",),
    thick_mm=0.6,
    view_deg=120.0,
    peak_nm=(468.0,),
    dominant_nm=(472.5,),
    band_nm=(25.0,),
)
