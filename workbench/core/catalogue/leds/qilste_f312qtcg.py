"""Qilste H11-F312QTCG/5M: green, 3.2 mm long."""

from __future__ import annotations

from workbench.core.catalogue.led_part import LedPart

LED = LedPart(
    title="Qilste H11-F312QTCG/5M",
    source="https://blog.csdn.net/QILSTELED/article/details/139883748",
    light=("green",),
    width_mm=3.2,
    height_mm=1.25,
    thick_mm=1.1,
    view_deg=120.0,
    peak_nm=(524.0,),
    dominant_nm=(528.5,),
    band_nm=(35.0,),
)
