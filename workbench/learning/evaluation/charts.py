"""Charts of an evaluation as inline SVG: lines over named steps, bars over names, histograms."""

from __future__ import annotations

import html
import math
from collections.abc import Mapping, Sequence

import numpy as np

from workbench.report.plot_axis import FAINT, INK, LINE, Axis, tick_text

WIDTH, HEIGHT = 480, 270
LEFT, RIGHT, TOP, BOTTOM = 66, 12, 34, 76
STROKES = ((LINE, ""), ("#b45309", "6 3"), ("#8b93a0", "2 3"))
"""Colours of lines; told apart in grey as well, as each has its own dashes."""
WAYS = ("learned", "mpm", "zero")
"""Those of an evaluation have the same stroke on every chart; others go by their order."""
WORDS = {"mpm": "contact solver"}
BINS = 12
LETTER_PX = 6.0
SLANTED = 7
"""From so many names on they are written at a slant."""


def lines(
    title: str, names: Sequence[str], series: Mapping[str, Sequence[float]], *, below: str
) -> str:
    """One line per way over the same names, from zero.

    Args:
        title: With the unit.
        names: Along the axis.
        series: Values by way, one for each name; what is not finite is left out.
        below: What the names are.
    """
    up = _up([value for values in series.values() for value in values])
    step = (WIDTH - LEFT - RIGHT) / max(len(names), 1)
    places = [LEFT + step * (number + 0.5) for number in range(len(names))]
    drawn = []
    for number, (way, values) in enumerate(series.items()):
        known = [(x, v) for x, v in zip(places, values, strict=True) if math.isfinite(v)]
        points = " ".join(f"{x:.1f},{up(value):.1f}" for x, value in known)
        dots = "".join(
            f"<circle cx='{x:.1f}' cy='{up(value):.1f}' r='3'><title>{value:.4g}</title></circle>"
            for x, value in known
        )
        colour, dash = _stroke(way, number)
        drawn.append(
            f"<polyline points='{points}' fill='none' stroke='{colour}' stroke-width='2' "
            f"stroke-dasharray='{dash}'/><g fill='{colour}'>{dots}</g>"
        )
    inner = _names(names, places) + "".join(drawn) + _legend(list(series))
    return _chart(title, up, inner, below, slanted=len(names) >= SLANTED)


def bars(
    title: str, names: Sequence[str], series: Mapping[str, Sequence[float]], *, below: str
) -> str:
    """Groups of bars, one bar per way, from zero; as `lines`."""
    up = _up([value for values in series.values() for value in values])
    step = (WIDTH - LEFT - RIGHT) / max(len(names), 1)
    width = 0.8 * step / max(len(series), 1)
    places = [LEFT + step * (number + 0.5) for number in range(len(names))]
    drawn = []
    for number, (way, values) in enumerate(series.items()):
        shift, (colour, _) = (number - len(series) / 2.0) * width, _stroke(way, number)
        for place, value in zip(places, values, strict=True):
            if math.isfinite(value):
                drawn.append(_bar(place + shift, width, up, value, colour))
    inner = _names(names, places) + "".join(drawn) + _legend(list(series))
    return _chart(title, up, inner, below, slanted=len(names) >= SLANTED)


def histogram(title: str, values: Sequence[float], *, below: str) -> str:
    """How many of the values fall between round numbers."""
    if not len(values):
        return f"<p>{html.escape(title)}: nothing to count.</p>"
    edges = np.linspace(min(0.0, *values), max(1e-12, *values), BINS + 1)
    counts, _ = np.histogram(values, edges)
    up = _up(counts.astype(float).tolist())
    across = Axis([float(edges[0]), float(edges[-1])], WIDTH - RIGHT, LEFT)
    drawn = "".join(
        _bar(across(low), across(high) - across(low) - 1.0, up, float(count), LINE)
        for low, high, count in zip(edges, edges[1:], counts, strict=False)
    )
    floor = HEIGHT - BOTTOM
    ticks = "".join(
        f"<text x='{across(v):.1f}' y='{floor + 16}' text-anchor='middle'>{tick_text(v)}</text>"
        for v in across.ticks
    )
    return _chart(title, up, f"<g font-size='11' fill='{INK}'>{ticks}</g>{drawn}", below)


def _up(values: Sequence[float]) -> Axis:
    finite = [value for value in values if math.isfinite(value)]
    return Axis([0.0, *finite] if finite else [0.0, 1.0], TOP, HEIGHT - BOTTOM)


def _bar(left: float, width: float, up: Axis, value: float, colour: str) -> str:
    top, floor = sorted((up(value), up(0.0)))
    return (
        f"<rect x='{left:.1f}' y='{top:.1f}' width='{max(width, 0.5):.1f}' "
        f"height='{floor - top:.1f}' fill='{colour}'><title>{value:.4g}</title></rect>"
    )


def _names(names: Sequence[str], places: Sequence[float]) -> str:
    y = HEIGHT - BOTTOM + 14
    slanted = len(names) >= SLANTED
    found = []
    for name, x in zip(names, places, strict=True):
        turn = f" transform='rotate(-35 {x:.1f} {y})'" if slanted else ""
        anchor = "end" if slanted else "middle"
        found.append(
            f"<text x='{x:.1f}' y='{y}' text-anchor='{anchor}'{turn}>{html.escape(name)}</text>"
        )
    return f"<g font-size='10' fill='{INK}'>{''.join(found)}</g>"


def _stroke(way: str, number: int) -> tuple[str, str]:
    """Colour and dashes of the line of a way, the `number`-th of its chart."""
    return STROKES[(WAYS.index(way) if way in WAYS else number) % len(STROKES)]


def _legend(ways: Sequence[str]) -> str:
    found, x = [], float(LEFT + 4)
    for number, way in enumerate(ways):
        colour, dash = _stroke(way, number)
        found.append(
            f"<path d='M{x:g},26 h22' stroke='{colour}' stroke-width='3' "
            f"stroke-dasharray='{dash}'/><text x='{x + 27:g}' y='30' font-size='11' "
            f"fill='{INK}'>{WORDS.get(way, way)}</text>"
        )
        x += 45.0 + LETTER_PX * len(WORDS.get(way, way))
    return "".join(found)


def _chart(title: str, up: Axis, inner: str, below: str, *, slanted: bool = False) -> str:
    foot = HEIGHT - 6 if slanted else HEIGHT - BOTTOM + 36
    safe = html.escape(title)
    grid = "".join(
        f"<path d='M{LEFT},{up(v):.1f} H{WIDTH - RIGHT}' stroke='{FAINT}'/>"
        f"<text x='{LEFT - 6}' y='{up(v) + 4:.1f}' text-anchor='end'>{tick_text(v)}</text>"
        for v in up.ticks
    )
    return (
        f"<svg viewBox='0 0 {WIDTH} {HEIGHT}' width='{WIDTH}' style='max-width:100%' role='img' "
        f"aria-label='{safe}'><text x='6' y='14' font-size='13' font-weight='600' fill='{INK}'>"
        f"{safe}</text><g font-size='11' fill='{INK}'>{grid}</g>{inner}"
        f"<text x='{LEFT}' y='{foot}' font-size='11' fill='{INK}'>{html.escape(below)}</text>"
        "</svg>"
    )
