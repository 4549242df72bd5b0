"""What happens in a frame of a press, and its numbers, in words for people.

Numbers that are not finite are written as a dash: no screen shows NaN.
"""

from __future__ import annotations

import math

import numpy as np

from workbench.core.press.press import Press
from workbench.view.choice_words import stroke_words

MISSING = "–"


def phase(press: Press, frame: int) -> str:
    """What happens in frame `frame`, counted from 1; 0 is the untouched skin."""
    if frame <= 0:
        return "untouched"
    driven = _driven(press, frame)
    return " · ".join(part for part in (_moved(press, frame), driven) if part)


def _moved(press: Press, frame: int) -> str:
    if press.trajectory is not None:
        return "trajectory" if frame <= press.trajectory.frame_count else "at rest"
    if frame <= press.frames:
        return "approach"
    if frame <= press.approach_frames:
        shear, twist = any(press.shear_mm), bool(press.twist_deg)
        return "shear and twist" if shear and twist else "shear" if shear else "twist"
    last = press.approach_frames
    for number, stroke in enumerate(press.strokes, start=1):
        last += stroke.frames
        if frame <= last:
            return f"stroke {number}: {stroke_words(stroke)}"
    return "at rest"


def _driven(press: Press, frame: int) -> str:
    """How far the driven regions are, where any moves."""
    shares = [actuation.share(float(frame)) for actuation in press.actuations]
    most = max(shares, key=abs, default=0.0)
    return f"driven {100.0 * most:.0f} %" if most else ""


def number(value: float, form: str = ".3g") -> str:
    """A number for the screen; a dash where it is not finite."""
    if not math.isfinite(value):
        return MISSING
    text = format(value, form)
    # A tiny negative number is no minus zero.
    return format(0.0, form) if float(text) == 0.0 else text


def of_frame(values: np.ndarray, frame: int) -> float:
    """Entry of a per-frame array, NaN where the result has none."""
    return float(values[frame]) if frame < len(values) else math.nan


def finite(values: np.ndarray) -> np.ndarray:
    """Values for a plot, 0 in place of what is not finite."""
    return np.nan_to_num(np.asarray(values, dtype=float), nan=0.0, posinf=0.0, neginf=0.0)
