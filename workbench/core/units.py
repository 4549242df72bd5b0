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
