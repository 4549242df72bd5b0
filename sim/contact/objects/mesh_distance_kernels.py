"""Taichi kernels of the mesh distance grid: exact distance in a band, and ray crossings.

The twin of both is in `reference`. Results do not depend on the number of threads: a plane of
samples belongs to one thread, and crossings are integer counts.
"""

# Taichi reads annotations and operators in its own way.
# pyright: reportGeneralTypeIssues=false, reportIndexIssue=false, reportOptionalCall=false

import taichi as ti

Samples = ti.types.ndarray(dtype=ti.f32, ndim=3)
Counts = ti.types.ndarray(dtype=ti.i32, ndim=3)
Triangles = ti.types.ndarray(dtype=ti.f32, ndim=3)
Corners = ti.types.ndarray(dtype=ti.f64, ndim=3)


@ti.func
def _squared_distance(p, a, b, c):
    """Squared distance of a point to a triangle (Ericson, Real-Time Collision Detection, 5.1.5)."""
    ab, ac, ap, bp, cp = b - a, c - a, p - a, p - b, p - c
    d1, d2 = ab.dot(ap), ac.dot(ap)
    d3, d4 = ab.dot(bp), ac.dot(bp)
    d5, d6 = ab.dot(cp), ac.dot(cp)
    va, vb, vc = d3 * d6 - d5 * d4, d5 * d2 - d1 * d6, d1 * d4 - d3 * d2
    nearest = a
    if d1 <= 0.0 and d2 <= 0.0:
        nearest = a
    elif d3 >= 0.0 and d4 <= d3:
        nearest = b
    elif vc <= 0.0 and d1 >= 0.0 and d3 <= 0.0:
        nearest = a + ab * (d1 / (d1 - d3))
    elif d6 >= 0.0 and d5 <= d6:
        nearest = c
    elif vb <= 0.0 and d2 >= 0.0 and d6 <= 0.0:
        nearest = a + ac * (d2 / (d2 - d6))
    elif va <= 0.0 and d4 >= d3 and d5 >= d6:
        nearest = b + (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6)))
    else:
        nearest = a + ab * (vb / (va + vb + vc)) + ac * (vc / (va + vb + vc))
    return (p - nearest).norm_sqr()


@ti.func
def _first_last(low, high, spacing, count):
    """Samples 0..count-1 whose coordinate lies in [low, high]."""
    first = ti.max(0, ti.cast(ti.ceil(low / spacing), ti.i32))
    last = ti.min(count - 1, ti.cast(ti.floor(high / spacing), ti.i32))
    return first, last


@ti.kernel
def band_distance(triangles: Triangles, squared: Samples, spacing: ti.f32, band: ti.f32):
    """Lower `squared` to the squared distance of every triangle nearer than `band`.

    Positions are measured from sample (0, 0, 0).
    """
    for i in range(squared.shape[0]):
        x = i * spacing
        for t in range(triangles.shape[0]):
            a = ti.Vector([triangles[t, 0, 0], triangles[t, 0, 1], triangles[t, 0, 2]])
            b = ti.Vector([triangles[t, 1, 0], triangles[t, 1, 1], triangles[t, 1, 2]])
            c = ti.Vector([triangles[t, 2, 0], triangles[t, 2, 1], triangles[t, 2, 2]])
            low = ti.min(a, b, c) - band
            high = ti.max(a, b, c) + band
            if x >= low[0] and x <= high[0]:
                j0, j1 = _first_last(low[1], high[1], spacing, squared.shape[1])
                k0, k1 = _first_last(low[2], high[2], spacing, squared.shape[2])
                for j in range(j0, j1 + 1):
                    for k in range(k0, k1 + 1):
                        place = ti.Vector([x, j * spacing, k * spacing])
                        found = _squared_distance(place, a, b, c)
                        if found < squared[i, j, k]:
                            squared[i, j, k] = found


@ti.kernel
def ray_crossings(corners: Corners, crossings: Counts, spacing: ti.f64):
    """Count signed crossings of the columns along the last axis.

    A crossing is added at the first sample above it, +1 where the surface faces down the axis
    (an entry) and -1 where it faces up (an exit), so the running sum along the column is the
    winding number.
    """
    for t in range(corners.shape[0]):
        ax, ay, az = corners[t, 0, 0], corners[t, 0, 1], corners[t, 0, 2]
        bx, by, bz = corners[t, 1, 0] - ax, corners[t, 1, 1] - ay, corners[t, 1, 2] - az
        cx, cy, cz = corners[t, 2, 0] - ax, corners[t, 2, 1] - ay, corners[t, 2, 2] - az
        area = bx * cy - cx * by
        if ti.abs(area) > 1e-14:
            low_x, high_x = ax + ti.min(bx, cx, 0.0), ax + ti.max(bx, cx, 0.0)
            low_y, high_y = ay + ti.min(by, cy, 0.0), ay + ti.max(by, cy, 0.0)
            i0 = ti.max(0, ti.cast(ti.ceil(low_x / spacing), ti.i32))
            i1 = ti.min(crossings.shape[0] - 1, ti.cast(ti.floor(high_x / spacing), ti.i32))
            j0 = ti.max(0, ti.cast(ti.ceil(low_y / spacing), ti.i32))
            j1 = ti.min(crossings.shape[1] - 1, ti.cast(ti.floor(high_y / spacing), ti.i32))
            for i in range(i0, i1 + 1):
                for j in range(j0, j1 + 1):
                    x, y = i * spacing - ax, j * spacing - ay
                    u, v = (x * cy - y * cx) / area, (y * bx - x * by) / area
                    if u >= 0.0 and v >= 0.0 and u + v < 1.0:
                        height = az + u * bz + v * cz
                        k = ti.max(0, ti.cast(ti.ceil(height / spacing), ti.i32))
                        if k < crossings.shape[2]:
                            # Integer sums do not depend on the order of the threads.
                            ti.atomic_add(crossings[i, j, k], ti.select(area < 0.0, 1, -1))
