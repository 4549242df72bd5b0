"""OptoSupply OSWA0402C1C: cool white, 0402."""

from __future__ import annotations

from workbench.core.catalogue.led_part import LedPart

LED = LedPart(
    title="OptoSupply OSWA0402C1C",
    source="https://cdn.shopify.com/s/files/1/0695/1347/8453/files/OSR50402C1C.pdf",
    light=("white",),
    width_mm=1.0,
    height_mm=0.5,
    thick_mm=0.4,
    view_deg=120.0,
    kelvin=7750.0,
    intensity_mcd=(400.0,),
    current_mA=20.0,
)
