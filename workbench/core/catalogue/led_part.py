"""An LED that can be bought. What no source says is None, and changes nothing.

An LED is one file of `workbench.core.catalogue.leds`; one with several dice has a value for each.
Its lobe is cos^m of the angle to its axis: m = ln 0.5 / ln cos(a / 2) for the angle a between the
directions of half the intensity, so that 120 degrees are Lambert's.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

from workbench.core.base.records import records
from workbench.core.base.units import radians


@dataclass(frozen=True, kw_only=True, slots=True)
class LedPart:
    """What is known of an LED."""

    title: str
    """As it is sold."""
    source: str
    """Address that gives every value, but for those of `sources`."""
    sources: Mapping[str, str] = field(default_factory=dict[str, str])
    """Addresses of single fields."""
    light: tuple[str, ...]
    """Names of its colours, in the order of the fields below."""
    width_mm: float | None = None
    """Body on the board [mm]."""
    height_mm: float | None = None
    thick_mm: float | None = None
    view_deg: float | None = None
    """Between the directions of half the intensity [degree]."""
    peak_nm: tuple[float, ...] = ()
    dominant_nm: tuple[float, ...] = ()
    """Of a range, its middle [nm]."""
    band_nm: tuple[float, ...] = ()
    """Width of the spectrum at half its peak [nm]."""
    kelvin: float | None = None
    """Colour temperature of a white; of a range, its middle [K]."""
    chromaticity: tuple[float, float] | None = None
    """CIE 1931 x, y of a white."""
    intensity_mcd: tuple[float, ...] = ()
    """Typical, at the current below [mcd]."""
    current_mA: float | None = None

    @property
    def exponent(self) -> float | None:
        """Exponent of the lobe [1]."""
        if self.view_deg is None:
            return None
        return math.log(0.5) / math.log(math.cos(0.5 * radians(self.view_deg)))

    @property
    def colours(self) -> tuple[str, ...]:
        """Its light as a design writes it; () where no source says it in numbers."""
        middle = self.peak_nm or self.dominant_nm
        if middle:
            bands = [f"/{band:g}nm" for band in self.band_nm] or [""] * len(middle)
            return tuple(f"{nm:g}nm{band}" for nm, band in zip(middle, bands, strict=True))
        kelvin = self.kelvin
        if kelvin is None and self.chromaticity is not None:
            kelvin = temperature(*self.chromaticity)
        return () if kelvin is None else (f"{kelvin:.0f}K",)


def temperature(x: float, y: float) -> float:
    """Correlated colour temperature of a white [K].

    Source: McCamy, Correlated color temperature as an explicit function of chromaticity
    coordinates, 1992.
    """
    n = (x - 0.3320) / (0.1858 - y)
    return 449.0 * n**3 + 3525.0 * n**2 + 6823.3 * n + 5520.33


def led_parts() -> dict[str, LedPart]:
    """All LEDs by name."""
    return records("workbench.core.catalogue.leds", "LED")
