"""A line chart as pixels: values over a count, the upright axis logarithmic."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

WIDTH, HEIGHT = 860, 480
LEFT, RIGHT, TOP, BOTTOM = 84, 190, 40, 44
COLOURS = ((37, 99, 235), (194, 65, 12), (22, 130, 80), (126, 34, 206))
GREY, FAINT, INK = (130, 130, 130), (222, 225, 230), (45, 45, 45)
STEPS = (1.0, 2.0, 5.0)


@dataclass(frozen=True, kw_only=True, slots=True)
class Series:
    """One line."""

    name: str
    points: tuple[tuple[float, float], ...]
    """Across and up; up is above zero."""
    reference: bool = False
    """Drawn thin and grey: what the others are to be seen beside."""

    @classmethod
    def of(
        cls,
        name: str,
        rows: Sequence[Mapping[str, Any]],
        across: str,
        up: str,
        *,
        reference: bool = False,
    ) -> Series:
        """From the columns of rows; rows without a value above zero are left out."""
        points = tuple((float(row[across]), float(row[up])) for row in rows if row.get(up))
        return cls(name=name, points=points, reference=reference)


def chart(series: Sequence[Series], title: str) -> np.ndarray:
    """The chart, sRGB, shape (HEIGHT, WIDTH, 3), uint8.

    Args:
        series: At least one, with at least one point each.
        title: Says what goes up, what across, and the units.
    """
    image = np.full((HEIGHT, WIDTH, 3), 255, np.uint8)
    xs = [x for each in series for x, _ in each.points]
    ys = [math.log10(y) for each in series for _, y in each.points]
    across = _axis(min(xs), max(xs), LEFT, WIDTH - RIGHT)
    up = _axis(min(ys) - 0.05, max(ys) + 0.05, HEIGHT - BOTTOM, TOP)
    _text(image, title, LEFT, 24, size=0.5)
    _grid(image, across, up, (min(xs), max(xs)), (min(ys) - 0.05, max(ys) + 0.05))
    colours = iter(COLOURS * len(series))
    for number, each in enumerate(series):
        colour = GREY if each.reference else next(colours)
        places = [(across(x), up(math.log10(y))) for x, y in each.points]
        _line(image, places, colour, 1 if each.reference else 2, dots=len(places) < 20)
        height = TOP + 16 + 34 * number
        _line(image, [(WIDTH - RIGHT + 12, height), (WIDTH - RIGHT + 34, height)], colour, 2)
        _text(image, each.name, WIDTH - RIGHT + 42, height + 4)
        _text(image, f"last {each.points[-1][1]:.3g}", WIDTH - RIGHT + 42, height + 19, colour)
    return image


def _axis(low: float, high: float, start_px: int, end_px: int) -> Callable[[float], int]:
    span = (high - low) or 1.0
    return lambda value: round(start_px + (value - low) / span * (end_px - start_px))


def _grid(
    image: np.ndarray,
    across: Callable[[float], int],
    up: Callable[[float], int],
    x_range: tuple[float, float],
    y_range: tuple[float, float],
) -> None:
    for value in _round_values(*x_range):
        x = across(value)
        _line(image, [(x, TOP), (x, HEIGHT - BOTTOM)], FAINT, 1)
        _text(image, f"{value:g}", x - 8, HEIGHT - BOTTOM + 18)
    for value in _decades(*y_range):
        y = up(math.log10(value))
        _line(image, [(LEFT, y), (WIDTH - RIGHT, y)], FAINT, 1)
        _text(image, f"{value:.2g}", 8, y + 4)


def _round_values(low: float, high: float) -> list[float]:
    """Round numbers between two ends, about six."""
    if high <= low:
        return [low]
    power = 10.0 ** math.floor(math.log10((high - low) / 6.0))
    step = next(k * power for k in (*STEPS, 10.0) if (high - low) / (k * power) <= 7.0)
    first = math.ceil(low / step - 1e-9)
    return [k * step for k in range(first, math.floor(high / step + 1e-9) + 1)]


def _decades(low: float, high: float) -> list[float]:
    """1, 2 and 5 times powers of ten between two logarithms; powers alone over many decades."""
    steps = STEPS if high - low < 3.0 else (1.0,)
    powers = range(math.floor(low), math.ceil(high) + 1)
    every = [step * 10.0**power for power in powers for step in steps]
    return [value for value in every if low <= math.log10(value) <= high]


def _line(
    image: np.ndarray,
    places: Sequence[tuple[int, int]],
    colour: tuple[int, int, int],
    width: int,
    *,
    dots: bool = False,
) -> None:
    import cv2

    points = np.array(places, np.int32).reshape(-1, 1, 2)
    cv2.polylines(image, [points], False, colour, width, cv2.LINE_AA)
    for place in places if dots else ():
        cv2.circle(image, place, 3, colour, -1, cv2.LINE_AA)


def _text(
    image: np.ndarray,
    text: str,
    x: int,
    y: int,
    colour: tuple[int, int, int] = INK,
    *,
    size: float = 0.4,
) -> None:
    import cv2

    cv2.putText(image, text, (x, y), cv2.FONT_HERSHEY_SIMPLEX, size, colour, 1, cv2.LINE_AA)
