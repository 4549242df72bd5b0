"""Radiance of skin vertices toward the camera, for every light model, in one kernel.

Per vertex and light, with x0 the undeformed place, x the present one, l the baked direction and E
the baked perpendicular irradiance:

    paper's fields  direction l, strength E, Phong's law
    direct          direction to the LED, E (g(x) / g(x0)), g = cos^m / r^2 within the cone
    hybrid          a virtual LED at x0 + l |LED - x0|: direction and r^-2 from there,
                    plus the table of scattered light
    table           the table alone

`direct` and `hybrid` fall into shadow where the moved patch comes between, the more the further
the vertex moved itself: skin that did not move keeps its light, so a shadow fades toward it.
`shading.shade` and `shading.relight` are the plain twins. Left out: light that moved skin scatters.
"""

# Taichi reads annotations and operators in its own way.
# pyright: reportInvalidTypeForm=false, reportGeneralTypeIssues=false, reportIndexIssue=false

import taichi as ti
import taichi.math as tm

from sim.optics.field.model import Shading
from sim.optics.field.table_kernels import look_up
from sim.optics.light.coating_kernels import reflected
from sim.optics.light.kernel_types import (
    FloatRows,
    FloatTables,
    FourRows,
    IntegerRows,
    Integers,
    NormalTables,
    Pairs,
    Vectors,
)
from sim.optics.raster.tree_kernels import nearest

FIELD, DIRECT, HYBRID, TABLE, GIVEN = (int(shading) for shading in Shading)
"""What an image makes of the light at a vertex: see `Shading`."""
NO_SHADOWS, FADING, EVERYWHERE = 0, 1, 2
"""Shadows of the moved patch: none, fading toward skin that did not move, or whole."""
EDGE_ON = 1e-6
"""Cosine below which light grazes the skin: single-precision rounding of a tangential field."""
SKIN_OFFSET_MM = 5e-3
"""Shadow rays start this far inside the skin [mm]; single precision resolves 4e-6 at 50 mm."""
CLOSEST_MM = 1e-3
"""Least distance of a vertex to a light [mm]; nearer, 1/r^2 has no meaning."""


@ti.func
def phong(light, view, normal, diffuse, specular, exponent):
    """Eq. 4 of the paper for one light of unit intensity."""
    total = 0.0
    facing = light.dot(normal)
    if facing > EDGE_ON:
        mirrored = 2.0 * facing * normal.dot(view) - light.dot(view)
        total = diffuse * facing
        if mirrored > 0.0:
            total += specular * ti.pow(mirrored, exponent)
    return total


@ti.func
def lobe(place, led, axis, shape):
    """cos^m / r^2 of an LED at a place, 0 outside its cone; `shape` is m and the cone's cosine."""
    line = led - place
    square = ti.max(line.norm_sqr(), CLOSEST_MM * CLOSEST_MM)
    cosine = -line.dot(axis) / ti.sqrt(square)
    strength = 0.0
    if cosine > 0.0 and cosine > shape.y:
        strength = ti.pow(cosine, shape.x) / square
    return strength


@ti.func
def arriving(way_of_lighting, was, here, baked, led, axis, shape):
    """Direction to a light, distance [mm] and perpendicular irradiance at a displaced vertex."""
    way, received, reach = baked.xyz, baked.w, 0.0
    if way_of_lighting != FIELD:
        source = led
        if way_of_lighting == HYBRID:
            source = was + way * ti.max((led - was).norm(), CLOSEST_MM)
        line = source - here
        reach = ti.max(line.norm(), CLOSEST_MM)
        way = line / reach
        if way_of_lighting == HYBRID:
            ratio = (source - was).norm() / reach
            received *= ratio * ratio
        else:
            then = lobe(was, source, axis, shape)
            now = lobe(here, source, axis, shape)
            received *= now / ti.max(then, 1e-20)
    return way, reach, received


@ti.func
def returned_share(way_of_lighting, way, view, inward, diffuse, specular, gloss):
    """Radiance per irradiance by the law of the model; `gloss` as in `shade_vertices`."""
    returned = 0.0
    if way_of_lighting == FIELD:
        returned = phong(way, view, inward, diffuse, specular, gloss)
    else:
        returned = reflected(way, view, inward, diffuse, specular, gloss)
    return returned


@ti.kernel
def shade_vertices(
    count: ti.i32,
    way_of_lighting: ti.i32,
    vertex_list: Integers,
    points: Vectors,
    normals: Vectors,
    placed: Vectors,
    turned: Vectors,
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
    least_mm: ti.f32,
    full_shadow_mm: ti.f32,
    shadows: ti.i32,
    levels: ti.i32,
    boxes: ti.i32,
    level_start: Integers,
    level_count: Integers,
    list_start: Integers,
    face_list: Integers,
    faces: IntegerRows,
    low: Vectors,
    high: Vectors,
    normal_low: Vectors,
    normal_high: Vectors,
    radiance: Vectors,
):
    """Radiance of each vertex on the list; `gloss` is Phong's exponent or GGX's roughness."""
    vertices = points.shape[0]
    for entry in range(count):
        at = vertex_list[entry]
        frame, vertex = at // vertices, at % vertices
        here, was = placed[at], points[vertex]
        inward, view = -turned[at], to_camera[at]
        total = tm.vec3(0.0)
        if way_of_lighting >= HYBRID:
            total = look_up(table, nodes, weights, node_frames, vertex, 0, inward)
        if way_of_lighting < TABLE:
            travel = (here - was).norm()
            depth = 0.0
            if shadows and way_of_lighting != FIELD:
                fade = ti.log(ti.max(travel, least_mm) / least_mm) / ti.log(
                    full_shadow_mm / least_mm
                )
                depth = ti.min(fade, 1.0)
                if shadows == EVERYWHERE:
                    depth = 1.0
            for number in range(led.shape[0]):
                baked = light[vertex, number]
                if baked.w > 0.0:
                    way, reach, received = arriving(
                        way_of_lighting,
                        was,
                        here,
                        baked,
                        led[number],
                        led_axis[number],
                        led_shape[number],
                    )
                    returned = returned_share(
                        way_of_lighting, way, view, inward, diffuse, specular, gloss
                    )
                    if returned > 0.0 and depth > 0.0:
                        blocker, _far = nearest(
                            frame,
                            here + SKIN_OFFSET_MM * inward,
                            way,
                            reach,
                            True,
                            levels,
                            boxes,
                            vertices,
                            level_start,
                            level_count,
                            list_start,
                            face_list,
                            faces,
                            normals,
                            placed,
                            low,
                            high,
                            normal_low,
                            normal_high,
                        )
                        if blocker >= 0:
                            returned *= 1.0 - depth
                    total += returned * received * led_rgb[number]
        radiance[at] = total
