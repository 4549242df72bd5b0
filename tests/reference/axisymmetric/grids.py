"""Sections of bodies of revolution as grids of quadrilaterals, of one or two orders.

A grid is a product of places along the skin and places from skin to floor; halving both lists
gives nested grids. Nodes are (r, z) [mm], the pole of the skin lies at (0, 0), the body below it.
Two-noded and three-noded edges are exact on the curve at their nodes only.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

Places = np.ndarray
Chart = Callable[[np.ndarray, np.ndarray], np.ndarray]
"""Way along the skin [mm] and depth below it [mm], both (...,), to (r, z) [mm], (..., 2)."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Grid:
    """A section."""

    points_mm: np.ndarray
    """Nodes (r, z), shape (N, 2)."""
    cells: np.ndarray
    """Nodes of each cell, rows of constant depth first, shape (E, (order + 1)^2)."""
    edges: np.ndarray
    """Nodes of the skin's edges, from the axis outwards, shape (S, order + 1)."""
    fixed: np.ndarray
    """Which of the 2 N displacements are held: floor and far end both, the axis its radial."""
    order: int

    @property
    def unknowns(self) -> int:
        """Displacements that are solved for."""
        return int((~self.fixed).sum())


def make_grid(chart: Chart, along_mm: Places, down_mm: Places, order: int, free_end: bool) -> Grid:
    """The grid of order 1 or 2 of a chart; `down_mm` runs from the skin to the floor.

    Args:
        chart: The section.
        along_mm: Places of the corners along the skin, from the axis.
        down_mm: Depths of the corners.
        order: Of the elements.
        free_end: Leaves the far end free; else it is held.
    """
    along, down = refined(along_mm, order), refined(down_mm, order)
    points = chart(*np.meshgrid(along, down, indexing="ij"))
    number = np.arange(along.size * down.size).reshape(along.size, down.size)
    window = range(order + 1)
    starts = np.ix_(range(0, along.size - 1, order), range(0, down.size - 1, order))
    cells = [number[starts[0] + i, starts[1] + j].ravel() for j in window for i in window]
    skin = number[:, 0]
    edges = [skin[i : along.size - order + i : order] for i in window]
    fixed = np.zeros((along.size, down.size, 2), dtype=bool)
    fixed[0, :, 0] = True
    fixed[:, -1] = True
    fixed[-1] |= not free_end
    return Grid(
        points_mm=points.reshape(-1, 2),
        cells=np.stack(cells, axis=1),
        edges=np.stack(edges, axis=1),
        fixed=fixed.ravel(),
        order=order,
    )


def refined(places: Places, parts: int) -> Places:
    """Every step cut into equal parts."""
    steps = len(places) - 1
    finer = np.linspace(0.0, steps, steps * parts + 1)
    return np.interp(finer, np.arange(steps + 1.0), places)


def growing(
    fine_mm: float, step_mm: float, length_mm: float, growth: tuple[float, float]
) -> Places:
    """Steps of `step_mm` as far as `fine_mm`, then growing ones, to a length.

    `growth` is the quotient of one step to the one before, and the largest step [mm].
    """
    factor, most_mm = growth
    steps = [step_mm] * max(1, round(fine_mm / step_mm))
    while sum(steps) < length_mm:
        steps.append(min(steps[-1] * factor, most_mm))
    places = np.concatenate([[0.0], np.cumsum(steps)])
    even = round(fine_mm / step_mm) if fine_mm > 0.0 else 0
    # The graded part is stretched to end on the length; the even part stays.
    tail = places[even:]
    places[even:] = tail[0] + (tail - tail[0]) * (length_mm - tail[0]) / (tail[-1] - tail[0])
    return places


def finger_chart(radius_mm: float) -> Chart:
    """A hemisphere on a cylinder; depth is measured along the normal."""
    quarter_mm = 0.5 * math.pi * radius_mm

    def chart(along_mm: np.ndarray, down_mm: np.ndarray) -> np.ndarray:
        angle = np.minimum(along_mm, quarter_mm) / radius_mm
        below_mm = np.maximum(along_mm - quarter_mm, 0.0)
        inner_mm = radius_mm - down_mm
        r_mm = inner_mm * np.sin(angle)
        r_mm[along_mm == 0.0] = 0.0
        return np.stack([r_mm, inner_mm * np.cos(angle) - radius_mm - below_mm], axis=-1)

    return chart


def disc_chart(along_mm: np.ndarray, down_mm: np.ndarray) -> np.ndarray:
    """A flat pad."""
    return np.stack([along_mm, -down_mm], axis=-1)
