"""The light of vertices at their tilts, and its slopes; `TiltLight` has the plain twins."""

# Taichi reads annotations and operators in its own way.
# pyright: reportInvalidTypeForm=false, reportGeneralTypeIssues=false, reportIndexIssue=false

import taichi as ti
import taichi.math as tm


@ti.func
def _looked_up(
    table: ti.template(), row: ti.i32, p: ti.f64, q: ti.f64, span: ti.f64, steps: ti.i32
) -> tm.vec3:
    """Between four entries of one vertex."""
    last = ti.cast(steps - 1, ti.f64)
    x = tm.clamp((p / span + 1.0) * 0.5 * last, 0.0, last - 1e-6)
    y = tm.clamp((q / span + 1.0) * 0.5 * last, 0.0, last - 1e-6)
    i, j = ti.cast(x, ti.i32), ti.cast(y, ti.i32)
    a, b = ti.cast(x - i, ti.f32), ti.cast(y - j, ti.f32)
    total = tm.vec3(0.0)
    for k, m in ti.static(ti.ndrange(2, 2)):
        along = a if ti.static(k == 1) else 1.0 - a
        across = b if ti.static(m == 1) else 1.0 - b
        for c in ti.static(range(3)):
            total[c] += along * across * table[row, i + k, j + m, c]
    return total


@ti.kernel
def light_at(
    table: ti.types.ndarray(dtype=ti.f32, ndim=4),
    rows: ti.types.ndarray(dtype=ti.i32, ndim=1),
    tilts: ti.types.ndarray(dtype=ti.f64, ndim=2),
    span: ti.f64,
    light: ti.types.ndarray(dtype=ti.f64, ndim=2),
):
    """Fill light (n, 3) with the radiance of some vertices (n,) at tilts (n, 2)."""
    for v in range(rows.shape[0]):
        found = _looked_up(table, rows[v], tilts[v, 0], tilts[v, 1], span, table.shape[1])
        for c in ti.static(range(3)):
            light[v, c] = found[c]


@ti.kernel
def slopes_at(
    table: ti.types.ndarray(dtype=ti.f32, ndim=4),
    rows: ti.types.ndarray(dtype=ti.i32, ndim=1),
    tilts: ti.types.ndarray(dtype=ti.f64, ndim=2),
    span: ti.f64,
    step: ti.f64,
    slopes: ti.types.ndarray(dtype=ti.f64, ndim=3),
):
    """Fill slopes (n, 3, 2) with central differences over a step of either tilt."""
    for v in range(rows.shape[0]):
        p, q, steps = tilts[v, 0], tilts[v, 1], table.shape[1]
        for way in ti.static(range(2)):
            up = step if ti.static(way == 0) else 0.0
            aside = step if ti.static(way == 1) else 0.0
            ahead = _looked_up(table, rows[v], p + up, q + aside, span, steps)
            behind = _looked_up(table, rows[v], p - up, q - aside, span, steps)
            for c in ti.static(range(3)):
                slopes[v, c, way] = ti.cast(ahead[c] - behind[c], ti.f64) / (2.0 * step)
