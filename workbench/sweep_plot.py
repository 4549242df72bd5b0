"""The plot of a sweep as inline SVG: one figure against the swept number, failed points marked.

Axes run over the values with round steps (1, 2 or 5 times a power of ten) between the ticks.
"""

from __future__ import annotations

import html
import math
from collections.abc import Sequence

from workbench.metric_rules import rule
from workbench.sweeps import Status, Sweep, base_value, curve

WIDTH, HEIGHT = 640, 300
LEFT, RIGHT, TOP, BOTTOM = 78, 20, 16, 46
LINE, FAILED, FAINT, INK = "#2563eb", "#c2410c", "#d5d9df", "#333"
TICKS = 5


def sweep_svg(sweep: Sweep, metric: str) -> str:
    """The plot; a sentence where no point has the figure."""
    x, y = curve(sweep, metric)
    about = rule(metric)
    if not x:
        return f"<p>No point has {html.escape(about.label)} yet.</p>"
    values = [point.value for point in sweep.points]
    across, up = _Axis(values, WIDTH - RIGHT, LEFT), _Axis(y, TOP, HEIGHT - BOTTOM)
    points = " ".join(f"{across(a):.1f},{up(b):.1f}" for a, b in zip(x, y, strict=True))
    dots = "".join(
        f"<circle cx='{across(a):.1f}' cy='{up(b):.1f}' r='4'>"
        f"<title>{a:.6g}: {b:.5g}</title></circle>"
        for a, b in zip(x, y, strict=True)
    )
    crosses = "".join(
        _cross(across(point.value), point.message)
        for point in sweep.points
        if point.status is Status.FAILED
    )
    unit = f" [{about.unit}]" if about.unit else ""
    base = f"; the base has {base_value(sweep):.6g}"
    title = f"{about.label}{unit} against {sweep.field.title}{base}"
    safe = html.escape(title)
    return (
        f"<svg viewBox='0 0 {WIDTH} {HEIGHT}' width='{WIDTH}' style='max-width:100%' role='img' "
        f"aria-label='{safe}'>{_grid(across, up)}"
        f"<polyline points='{points}' fill='none' stroke='{LINE}' stroke-width='2'/>"
        f"<g fill='{LINE}'>{dots}</g>{crosses}"
        f"<text x='{LEFT}' y='{HEIGHT - 6}' font-size='12' fill='{INK}'>{safe}</text></svg>"
    )


class _Axis:
    """From values to pixels; the ends are round steps beyond the values."""

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


def _grid(across: _Axis, up: _Axis) -> str:
    floor, right = HEIGHT - BOTTOM, WIDTH - RIGHT
    lines = [
        f"<path d='M{LEFT},{up(v):.1f} H{right}' stroke='{FAINT}'/>"
        f"<text x='{LEFT - 6}' y='{up(v) + 4:.1f}' text-anchor='end'>{_tick(v)}</text>"
        for v in up.ticks
    ]
    lines += [
        f"<path d='M{across(v):.1f},{TOP} V{floor}' stroke='{FAINT}'/>"
        f"<text x='{across(v):.1f}' y='{floor + 16}' text-anchor='middle'>{_tick(v)}</text>"
        for v in across.ticks
    ]
    return f"<g font-size='12' fill='{INK}'>{''.join(lines)}</g>"


def _tick(value: float) -> str:
    return f"{0.0 if abs(value) < 1e-12 else value:.4g}"


def _cross(x: float, message: str) -> str:
    y = HEIGHT - BOTTOM
    return (
        f"<path d='M{x - 5:.1f},{y - 5} l10,10 m0,-10 l-10,10' stroke='{FAILED}' stroke-width='2'>"
        f"<title>failed: {html.escape(message)}</title></path>"
    )
