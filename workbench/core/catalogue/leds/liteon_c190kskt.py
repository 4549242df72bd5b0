"""Lite-On LTST-C190KSKT: yellow, 0.8 mm high, water clear."""

from __future__ import annotations

from workbench.core.catalogue.led_part import LedPart

LED = LedPart(
    title="Lite-On LTST-C190KSKT",
    source="https://manualmachine.com/datasheet/ltstc190kskt/27842967-specification",
    light=("yellow",),
    thick_mm=0.8,
    view_deg=130.0,
    peak_nm=(588.0,),
    dominant_nm=(590.75,),
    band_nm=(15.0,),
    current_mA=20.0,
)
