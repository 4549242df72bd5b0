"""Radiance of single points of the skin for two normals: what a tilt changes, on the device.

A point in a triangle takes the light of the three corners: each corner is shaded with the point's
normal, by the same functions as vertices are, and the three are weighed. So tilted and untilted
normal see exactly the same light, and equal normals differ by nothing. Shadows are left to the
caller. The plain twins are those of `shade_kernels`: `shading.shade`, `shading.relight` and
`table.look_up`, corner by corner.
"""

# Taichi reads annotations and operators in its own way.
# pyright: reportInvalidTypeForm=false, reportGeneralTypeIssues=false, reportIndexIssue=false

import taichi as ti
import taichi.math as tm

from sim.optics.field.table_kernels import look_up
from sim.optics.light.kernel_types import (
    FloatRows,
    FloatTables,
    FourRows,
    IntegerRows,
    NormalTables,
    Pairs,
    Vectors,
)
from sim.optics.raster.shade_kernels import HYBRID, TABLE, arriving, returned_share


@ti.kernel
def shade_points(
    count: ti.i32,
    way_of_lighting: ti.i32,
    corners: IntegerRows,
    shares: FloatRows,
    smooth: Vectors,
    tilted: Vectors,
    points: Vectors,
    placed: Vectors,
    to_camera: Vectors,
    light: FourRows,
    led: Vectors,
    led_axis: Vectors,
    led_rgb: Vectors,
    led_shape: Pairs,
    table: NormalTables,
    nodes: IntegerRows,
    weights: FloatRows,
    node_frames: FloatTables,
    diffuse: ti.f32,
    specular: ti.f32,
    gloss: ti.f32,
    before: Vectors,
    after: Vectors,
):
    """Fill `before` and `after` with the radiance for inward unit normals `smooth` and `tilted`.

    Args:
        corners: Vertices of each point's triangle, shape (count, 3).
        shares: Their weights, shape (count, 3).
    """
    for entry in range(count):
        old, new = tm.vec3(0.0), tm.vec3(0.0)
        for corner in range(3):
            vertex, share = corners[entry, corner], shares[entry, corner]
            here, was, view = placed[vertex], points[vertex], to_camera[vertex]
            if way_of_lighting >= HYBRID:
                old += share * look_up(table, nodes, weights, node_frames, vertex, 0, smooth[entry])
                new += share * look_up(table, nodes, weights, node_frames, vertex, 0, tilted[entry])
            if way_of_lighting < TABLE:
                for number in range(led.shape[0]):
                    baked = light[vertex, number]
                    if baked.w > 0.0:
                        way, _reach, received = arriving(
                            way_of_lighting,
                            was,
                            here,
                            baked,
                            led[number],
                            led_axis[number],
                            led_shape[number],
                        )
                        strength = share * received * led_rgb[number]
                        old += strength * returned_share(
                            way_of_lighting, way, view, smooth[entry], diffuse, specular, gloss
                        )
                        new += strength * returned_share(
                            way_of_lighting, way, view, tilted[entry], diffuse, specular, gloss
                        )
        before[entry] = old
        after[entry] = new
