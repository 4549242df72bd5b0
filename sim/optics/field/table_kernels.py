"""Radiance by the tilt of the normal: look-up, and collapse of light by direction to a table.

`look_up` is meant for shading kernels; `table.look_up` is its plain twin. `collapse` sums the light
of all directions through the coating for each tilted normal; `table.collapse` is its twin. All of
it happens in the frame (t, b, n) of a node, so nothing here knows where the node lies.
"""

# Taichi reads annotations and operators in its own way.
# pyright: reportInvalidTypeForm=false, reportGeneralTypeIssues=false, reportIndexIssue=false

import taichi as ti
import taichi.math as tm

from sim.optics.light.coating_kernels import reflected
from workbench.core.result.light import FLATTEST, TILT_SPAN, TILTS


@ti.func
def look_up(
    table: ti.template(),
    nodes: ti.template(),
    weights: ti.template(),
    frames: ti.template(),
    vertex: ti.i32,
    camera: ti.i32,
    normal: tm.vec3,
) -> tm.vec3:
    """Radiance of a vertex with a unit normal into the sensor, toward one camera.

    Args:
        table: `NormalTable.values`, shape (C, N, TILTS, TILTS, 3), f32.
        nodes: `Scattered.nodes`, shape (V, 3), i32.
        weights: `Scattered.weights`, shape (V, 3), f32.
        frames: `Scattered.frame`, shape (N, 3, 3), f32.
    """
    total = tm.vec3(0.0)
    for corner in ti.static(range(3)):
        node = nodes[vertex, corner]
        share = weights[vertex, corner]
        if share > 0.0:
            t = tm.vec3(frames[node, 0, 0], frames[node, 0, 1], frames[node, 0, 2])
            b = tm.vec3(frames[node, 1, 0], frames[node, 1, 1], frames[node, 1, 2])
            row, column = _place(normal.dot(t)), _place(normal.dot(b))
            low, left = ti.cast(row, ti.i32), ti.cast(column, ti.i32)
            up, right = row - low, column - left
            for i, j in ti.static(ti.ndrange(2, 2)):
                across = up if ti.static(i == 1) else 1.0 - up
                along = right if ti.static(j == 1) else 1.0 - right
                for c in ti.static(range(3)):
                    found = table[camera, node, low + i, left + j, c]
                    total[c] += share * across * along * found
    return total


@ti.func
def _place(component: ti.f32) -> ti.f32:
    """Row or column of a tangential component, inside the table."""
    place = (component / TILT_SPAN + 1.0) * 0.5 * (TILTS - 1)
    return tm.clamp(place, 0.0, TILTS - 1.001)


@ti.func
def tilted(row: ti.i32, column: ti.i32) -> tm.vec3:
    """Unit normal of a table entry in the node's frame; corners beyond the horizon come back."""
    x = (2.0 * row / (TILTS - 1) - 1.0) * TILT_SPAN
    y = (2.0 * column / (TILTS - 1) - 1.0) * TILT_SPAN
    flat = x * x + y * y
    if flat > 1.0 - FLATTEST:
        back = ti.sqrt((1.0 - FLATTEST) / flat)
        x, y, flat = x * back, y * back, 1.0 - FLATTEST
    return tm.vec3(x, y, ti.sqrt(1.0 - flat))


@ti.kernel
def collapse(
    received: ti.types.ndarray(dtype=ti.f32, ndim=3),
    directions: ti.types.ndarray(dtype=tm.vec3, ndim=1),
    views: ti.types.ndarray(dtype=tm.vec3, ndim=1),
    albedo: ti.f32,
    specular: ti.f32,
    roughness: ti.f32,
    values: ti.types.ndarray(dtype=ti.f32, ndim=4),
):
    """values[node, row, column] = sum over directions of received x coating.

    Args:
        received: Perpendicular irradiance, shape (N, 3, D).
        directions: Toward the light, in the node's frame, shape (D, 3).
        views: Toward the camera, in each node's frame, shape (N, 3).
        values: Filled, shape (N, TILTS, TILTS, 3).
    """
    for node, row, column in ti.ndrange(received.shape[0], TILTS, TILTS):
        normal = tilted(row, column)
        view = views[node]
        total = tm.vec3(0.0)
        for d in range(directions.shape[0]):
            light = tm.vec3(received[node, 0, d], received[node, 1, d], received[node, 2, d])
            toward = directions[d]
            if normal.dot(toward) > 0.0:
                total += light * reflected(toward, view, normal, albedo, specular, roughness)
        for c in ti.static(range(3)):
            values[node, row, column, c] = total[c]
