"""The one place that converts units. Inside: mm, N, MPa (= N/mm2), s, tonne, radian."""

from __future__ import annotations

import math

ML_PER_MM3 = 1e-3


def radians(angle_deg: float) -> float:
    """Angle [rad] of an angle [degree]."""
    return math.radians(angle_deg)


def volume_ml(volume_mm3: float) -> float:
    """Volume [ml] of a volume [mm3]."""
    return volume_mm3 * ML_PER_MM3


def human_seconds(duration_s: float) -> str:
    """A duration as a person reads it: `0.4 s`, `12 s`, `3 min 05 s`."""
    if duration_s < 10:
        return f"{duration_s:.1f} s"
    if duration_s < 60:
        return f"{duration_s:.0f} s"
    minutes, seconds = divmod(round(duration_s), 60)
    return f"{minutes} min {seconds:02d} s"


UNITS = {
    "mm": "mm",
    "mm2": "mm²",
    "mm3": "mm³",
    "deg": "°",
    "N": "N",
    "MPa": "MPa",
    "px": "px",
    "percent": "%",
    "s": "s",
    "ml": "ml",
    "g": "g",
    "dB": "dB",
    "K": "K",
    "e": "electrons",
}
"""Endings of names and the units that people read."""


def split_unit(name: str) -> tuple[str, str]:
    """A name with its unit, for example `press_depth_mm`, as label and unit for people."""
    if name.endswith("_g_cm3"):
        return name.removesuffix("_g_cm3").replace("_", " "), "g/cm³"
    stem, _, ending = name.rpartition("_")
    if stem and ending in UNITS:
        return stem.replace("_", " "), UNITS[ending]
    return name.replace("_", " "), ""
