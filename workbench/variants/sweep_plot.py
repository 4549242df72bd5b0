"""The plot of a sweep as inline SVG: one figure against the swept number, failed points marked.

Axes run over the values with round steps (1, 2 or 5 times a power of ten) between the ticks.
"""

from __future__ import annotations

import html

from workbench.report.plot_axis import FAILED, INK, LINE, Axis, grid_lines
from workbench.variants.sweeps import Status, Sweep, base_value, curve
from workbench.view.metric_rules import rule

WIDTH, HEIGHT = 640, 300
LEFT, RIGHT, TOP, BOTTOM = 78, 20, 16, 46


def sweep_svg(sweep: Sweep, metric: str) -> str:
    """The plot; a sentence where no point has the figure."""
    x, y = curve(sweep, metric)
    about = rule(metric)
    if not x:
        return f"<p>No point has {html.escape(about.label)} yet.</p>"
    values = [point.value for point in sweep.points]
    across, up = Axis(values, WIDTH - RIGHT, LEFT), Axis(y, TOP, HEIGHT - BOTTOM)
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
        f"aria-label='{safe}'><g font-size='12' fill='{INK}'>"
        f"{grid_lines(across, up)}</g>"
        f"<polyline points='{points}' fill='none' stroke='{LINE}' stroke-width='2'/>"
        f"<g fill='{LINE}'>{dots}</g>{crosses}"
        f"<text x='{LEFT}' y='{HEIGHT - 6}' font-size='12' fill='{INK}'>{safe}</text></svg>"
    )


def _cross(x: float, message: str) -> str:
    y = HEIGHT - BOTTOM
    return (
        f"<path d='M{x - 5:.1f},{y - 5} l10,10 m0,-10 l-10,10' stroke='{FAILED}' stroke-width='2'>"
        f"<title>failed: {html.escape(message)}</title></path>"
    )
