"""Quadratic B-spline sums over the 27 nodes of a cell at its 2x2x2 points, sum-factorised.

In one dimension a point at xi (in cells, from the centre node) sees the nodes -1, 0, +1 with
weights (1/2 - xi)^2 / 2, 3/4 - xi^2, (1/2 + xi)^2 / 2. With the even part q = t0 - 2 t1 + t2 and
the odd part d = t2 - t0 of three nodal values t,

    value(xi) = t1 + (1/8 + xi^2 / 2) q + (xi / 2) d,      slope(xi) = d / 2 + xi q,

so the two points xi = -1/4 and +1/4 share nearly all work. A tensor product of three such sums
replaces 8 x 27 weights per component by about 270 operations.

The functions are plain Python over numbers, NumPy arrays or Taichi expressions; a kernel passes
`keep`, which makes an expression a local variable so that it is computed once. The plain twin of
both sums is `weight_table` and `gradient_table`.

Orders: node n = 9 i + 3 j + k with i, j, k in 0..2 along x, y, z; point p = 4 bx + 2 by + bz.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable
from typing import Any

import numpy as np

POINT_OFFSET = 0.25
"""Distance of a point from its cell's centre on each axis, in cells (2x2x2 lattice points)."""

Keep = Callable[[Any], Any]
Pair = tuple[Any, Any]

_EVEN = 0.125 + 0.5 * POINT_OFFSET**2
_ODD = 0.5 * POINT_OFFSET
_BITS = (0, 1)
_NODES = (0, 1, 2)


def itself(expression: Any) -> Any:
    """The `keep` of plain numbers and arrays."""
    return expression


def _values(nodes: list[Any], keep: Keep) -> Pair:
    low, middle, high = nodes
    centre = keep(middle + _EVEN * (low + high - 2.0 * middle))
    odd = keep(_ODD * (high - low))
    return keep(centre - odd), keep(centre + odd)


def _slopes(nodes: list[Any], keep: Keep) -> Pair:
    low, middle, high = nodes
    centre = keep(0.5 * (high - low))
    odd = keep(POINT_OFFSET * (low + high - 2.0 * middle))
    return keep(centre - odd), keep(centre + odd)


def _values_transposed(pair: Pair, keep: Keep) -> list[Any]:
    total = keep(pair[0] + pair[1])
    even = keep(_EVEN * total)
    odd = keep(_ODD * (pair[1] - pair[0]))
    return [keep(even - odd), keep(total - 2.0 * even), keep(even + odd)]


def _slopes_transposed(pair: Pair, keep: Keep) -> list[Any]:
    even = keep(POINT_OFFSET * (pair[1] - pair[0]))
    odd = keep(0.5 * (pair[0] + pair[1]))
    return [keep(even - odd), keep(-2.0 * even), keep(even + odd)]


def _both_transposed(values: Pair, slopes: Pair, keep: Keep) -> list[Any]:
    total = keep(values[0] + values[1])
    even = keep(_EVEN * total + POINT_OFFSET * (slopes[1] - slopes[0]))
    odd = keep(_ODD * (values[1] - values[0]) + 0.5 * (slopes[0] + slopes[1]))
    return [keep(even - odd), keep(total - 2.0 * even), keep(even + odd)]


def gather_gradient(nodal: list[Any], keep: Keep = itself) -> list[list[Any]]:
    """Derivatives by x, y, z, times the cell edge, of one component at the 8 points.

    Args:
        nodal: The 27 nodal values.
        keep: Makes an intermediate a local variable.

    Returns:
        Eight triples (d/dx, d/dy, d/dz) times the cell edge.
    """
    value_x, slope_x = {}, {}
    for j, k in itertools.product(_NODES, _NODES):
        line = [nodal[9 * i + 3 * j + k] for i in _NODES]
        value_x[j, k], slope_x[j, k] = _values(line, keep), _slopes(line, keep)
    value_xy, slope_x_y, value_x_slope_y = {}, {}, {}
    for bit_x, k in itertools.product(_BITS, _NODES):
        line = [value_x[j, k][bit_x] for j in _NODES]
        value_xy[bit_x, k] = _values(line, keep)
        value_x_slope_y[bit_x, k] = _slopes(line, keep)
        slope_x_y[bit_x, k] = _values([slope_x[j, k][bit_x] for j in _NODES], keep)
    gradients: list[list[Any]] = []
    for bit_x, bit_y in itertools.product(_BITS, _BITS):
        by_x = _values([slope_x_y[bit_x, k][bit_y] for k in _NODES], keep)
        by_y = _values([value_x_slope_y[bit_x, k][bit_y] for k in _NODES], keep)
        by_z = _slopes([value_xy[bit_x, k][bit_y] for k in _NODES], keep)
        gradients += [[by_x[bit_z], by_y[bit_z], by_z[bit_z]] for bit_z in _BITS]
    return gradients


def scatter_gradient(flux: list[list[Any]], keep: Keep = itself) -> list[Any]:
    """Transpose of `gather_gradient`: 27 nodal values from a vector at each of the 8 points.

    Args:
        flux: Eight triples; triple p is contracted with the weight gradients at point p, times
            the cell edge.
        keep: Makes an intermediate a local variable.
    """
    by_x, by_y, by_z = {}, {}, {}
    for bit_x, bit_y in itertools.product(_BITS, _BITS):
        low, high = flux[4 * bit_x + 2 * bit_y], flux[4 * bit_x + 2 * bit_y + 1]
        by_x[bit_x, bit_y] = _values_transposed((low[0], high[0]), keep)
        by_y[bit_x, bit_y] = _values_transposed((low[1], high[1]), keep)
        by_z[bit_x, bit_y] = _slopes_transposed((low[2], high[2]), keep)
    value_x, slope_x = {}, {}
    for bit_x, k in itertools.product(_BITS, _NODES):
        values = (by_z[bit_x, 0][k], by_z[bit_x, 1][k])
        slopes = (by_y[bit_x, 0][k], by_y[bit_x, 1][k])
        value_x[bit_x, k] = _both_transposed(values, slopes, keep)
        slope_x[bit_x, k] = _values_transposed((by_x[bit_x, 0][k], by_x[bit_x, 1][k]), keep)
    nodal: list[Any] = [None] * 27
    for j, k in itertools.product(_NODES, _NODES):
        values = (value_x[0, k][j], value_x[1, k][j])
        slopes = (slope_x[0, k][j], slope_x[1, k][j])
        for i, entry in zip(_NODES, _both_transposed(values, slopes, keep), strict=True):
            nodal[9 * i + 3 * j + k] = entry
    return nodal


def line_weights(local: np.ndarray) -> np.ndarray:
    """Weights of the nodes -1, 0, +1 at positions in [-1/2, 1/2] cells, shape (..., 3)."""
    return np.stack([0.5 * (0.5 - local) ** 2, 0.75 - local**2, 0.5 * (0.5 + local) ** 2], axis=-1)


def line_slopes(local: np.ndarray) -> np.ndarray:
    """Derivatives of `line_weights` by the position in cells, shape (..., 3)."""
    return np.stack([local - 0.5, -2.0 * local, local + 0.5], axis=-1)


def point_weights(local: np.ndarray) -> np.ndarray:
    """The 27 weights at points given in cells from their cell's centre, (P, 3) to (P, 27)."""
    x, y, z = np.moveaxis(line_weights(local), 1, 0)
    return np.einsum("pi,pj,pk->pijk", x, y, z).reshape(len(local), 27)


def point_slopes(local: np.ndarray) -> np.ndarray:
    """Gradients of the 27 weights, times the cell edge, at points (P, 3), shape (P, 27, 3)."""
    weights, slopes = line_weights(local), line_slopes(local)
    axes = []
    for axis in range(3):
        x, y, z = (slopes[:, c] if c == axis else weights[:, c] for c in range(3))
        axes.append(np.einsum("pi,pj,pk->pijk", x, y, z).reshape(len(local), 27))
    return np.stack(axes, axis=-1)


def point_offsets() -> np.ndarray:
    """Positions of the 8 points from the cell's centre, in cells, shape (8, 3)."""
    bits = np.array(list(itertools.product(_BITS, repeat=3)))
    return POINT_OFFSET * (2.0 * bits - 1.0)


def weight_table() -> np.ndarray:
    """Weights of the 27 nodes at the 8 points, shape (8, 27)."""
    return point_weights(point_offsets())


def gradient_table() -> np.ndarray:
    """Weight gradients, times the cell edge, at the 8 points, shape (8, 27, 3)."""
    return point_slopes(point_offsets())
