"""Colours for numbers: the viridis map, uniform to the eye and safe for colour-blind people."""

from __future__ import annotations

import functools

import numpy as np

VIRIDIS = np.array(
    [
        (0.2777273, 0.0054073, 0.3340998),
        (0.1050930, 1.4046135, 1.3845902),
        (-0.3308618, 0.2148476, 0.0950952),
        (-4.6342305, -5.7991010, -19.3324410),
        (6.2282700, 14.1799334, 56.6905526),
        (4.7763850, -13.7451454, -65.3530326),
        (-5.4354559, 4.6458526, 26.3124352),
    ]
)
"""Polynomial in t of the viridis map. Source: M. Zucker, CC0."""
STEPS = 1024
NOTHING_GREY = (92, 92, 98)
"""Where there is no number."""


def viridis(share: np.ndarray) -> np.ndarray:
    """Colours, shape (..., 3) uint8, of values in [0, 1] of any shape; beyond, the ends'."""
    step = np.nan_to_num(np.clip(share, 0.0, 1.0)) * (STEPS - 1)
    return _table()[np.rint(step).astype(np.int32)]


@functools.cache
def _table() -> np.ndarray:
    t = np.linspace(0.0, 1.0, STEPS)[:, None]
    colour = np.zeros((STEPS, 3))
    for coefficient in VIRIDIS[::-1]:
        colour = colour * t + coefficient
    return (np.clip(colour, 0.0, 1.0) * 255).astype(np.uint8)


def scale_colours(values: np.ndarray, low: float, high: float) -> np.ndarray:
    """Viridis from `low` to `high`, grey where a value is NaN, shape (..., 3), uint8."""
    span = max(high - low, 1e-30)
    colours = viridis((np.asarray(values, dtype=np.float64) - low) / span)
    colours[np.isnan(values)] = NOTHING_GREY
    return colours


YES: tuple[int, int, int] = (int(_table()[-1][0]), int(_table()[-1][1]), int(_table()[-1][2]))
"""The upper end of the scale."""
