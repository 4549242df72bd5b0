"""An axis of a plot drawn as SVG: from values to pixels, with round steps between the ticks."""

from __future__ import annotations

import math
from collections.abc import Sequence

TICKS = 5
LINE, FAILED, FAINT, INK = "#2563eb", "#c2410c", "#d5d9df", "#333"
"""Colours of plots on white paper."""


class Axis:
    """From values to pixels; the ends are round steps (1, 2, 5 times a power of ten) beyond."""

    def __init__(self, values: Sequence[float], high_px: float, low_px: float) -> None:
        low, high = min(values), max(values)
        if high - low <= 1e-12 * max(abs(low), abs(high), 1e-300):
            margin = abs(low) * 0.1 or 1.0
            low, high = low - margin, high + margin
        self.step = _round_step((high - low) / TICKS)
        self.low = math.floor(low / self.step + 1e-9) * self.step
        self.high = math.ceil(high / self.step - 1e-9) * self.step
        self.low_px, self.high_px = low_px, high_px

    def __call__(self, value: float) -> float:
        share = (value - self.low) / (self.high - self.low)
        return self.low_px + share * (self.high_px - self.low_px)

    @property
    def ticks(self) -> list[float]:
        """Round values from end to end."""
        count = round((self.high - self.low) / self.step)
        return [self.low + k * self.step for k in range(count + 1)]


def _round_step(step: float) -> float:
    power = 10.0 ** math.floor(math.log10(step))
    return next(
        factor * power for factor in (1.0, 2.0, 5.0, 10.0) if factor * power >= 0.999 * step
    )


def tick_text(value: float) -> str:
    """A number beside a tick; what is left of rounding is 0."""
    return f"{0.0 if abs(value) < 1e-12 else value:.4g}"


def grid_lines(across: Axis, up: Axis) -> str:
    """A line and a number at each tick of both axes of a plot, as SVG."""
    left, right, top, floor = across.low_px, across.high_px, up.high_px, up.low_px
    lines = [
        f"<path d='M{left},{up(v):.1f} H{right}' stroke='{FAINT}'/>"
        f"<text x='{left - 6}' y='{up(v) + 4:.1f}' text-anchor='end'>{tick_text(v)}</text>"
        for v in up.ticks
    ]
    lines += [
        f"<path d='M{across(v):.1f},{top} V{floor}' stroke='{FAINT}'/>"
        f"<text x='{across(v):.1f}' y='{floor + 16}' text-anchor='middle'>{tick_text(v)}</text>"
        for v in across.ticks
    ]
    return "".join(lines)
