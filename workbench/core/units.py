"""The one place that converts units. Inside: mm, N, MPa (= N/mm2), s, tonne, radian."""

from __future__ import annotations

import math

MM_PER_M = 1e3
MM_PER_INCH = 25.4
MPA_PER_PA = 1e-6
TONNE_PER_MM3_PER_G_PER_CM3 = 1e-9
ML_PER_MM3 = 1e-3


def radians(angle_deg: float) -> float:
    """Angle [rad] of an angle [degree]."""
    return math.radians(angle_deg)


def density_t_mm3(density_g_cm3: float) -> float:
    """Density [tonne/mm3] of a density [g/cm3]; 1 g/cm3 is 1e-9 tonne/mm3."""
    return density_g_cm3 * TONNE_PER_MM3_PER_G_PER_CM3


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
