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
A light is a disc that faces the vertex, and its shadow the share of the disc that is covered:
Points of it are looked for, the outer four first, which mostly agree. Where the triangles could not
show the penumbra the disc is larger, so that no shadow shows their edges.
`shading.shade` and `shading.relight` are the plain twins. Left out: light that moved skin scatters.
"""

# Taichi reads annotations and operators in its own way.
# pyright: reportInvalidTypeForm=false, reportGeneralTypeIssues=false, reportIndexIssue=false

import math

import taichi as ti
import taichi.math as tm

from sim.optics.field.model import Shading
from sim.optics.field.table_kernels import look_up
from sim.optics.light.coating_kernels import reflected
from sim.optics.light.kernel_types import Integers, Vectors
from sim.optics.raster.bundles import Law, Lights, Posed, ScatteredLight, Skin, Tree
from sim.optics.raster.tree_kernels import nearest

FIELD, DIRECT, HYBRID, TABLE, GIVEN = (int(shading) for shading in Shading)
"""What an image makes of the light at a vertex: see `Shading`."""
NO_SHADOWS, FADING, EVERYWHERE = 0, 1, 2
"""Shadows of the moved patch: none, fading toward skin that did not move, or whole."""
EDGE_ON = 1e-6
"""Cosine below which light grazes the skin: single-precision rounding of a tangential field."""
SKIN_OFFSET_MM = 5e-3
"""Shadow rays start this far inside the skin [mm]; single precision resolves 4e-6 at 50 mm."""
OUTER_POINTS, INNER_POINTS = math.sqrt(0.75), 0.5
"""Radii of eight points that stand for equal parts of a unit disc, four each: the roots of the mean
square radius outside and inside the circle that halves it [1]."""
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
def arriving(way_of_lighting, was, here, vertex, number, lights: ti.template()):
    """Direction to a light, distance [mm] and perpendicular irradiance at a displaced vertex."""
    baked, led = lights.light[vertex, number], lights.led[number]
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
            axis, shape = lights.led_axis[number], lights.led_shape[number]
            then = lobe(was, source, axis, shape)
            now = lobe(here, source, axis, shape)
            received *= now / ti.max(then, 1e-20)
    return way, reach, received


@ti.func
def returned_share(way, view, inward, law: ti.template()):
    """Radiance per irradiance by the law of the model."""
    returned = 0.0
    if law.way_of_lighting == FIELD:
        returned = phong(way, view, inward, law.diffuse, law.specular, law.gloss)
    else:
        returned = reflected(way, view, inward, law.diffuse, law.specular, law.gloss)
    return returned


@ti.func
def scattered_to(vertex, inward, scattered: ti.template()):
    """Radiance of scattered light that a vertex of this inward unit normal sends to the camera."""
    return look_up(
        scattered.table,
        scattered.nodes,
        scattered.weights,
        scattered.node_frames,
        vertex,
        0,
        inward,
    )


@ti.func
def share_moved(travel, law: ti.template()):
    """0 of skin at rest to 1 of skin that moved far enough [mm] to take the whole shadow."""
    fade = ti.log(ti.max(travel, law.least_mm) / law.least_mm) / ti.log(
        law.full_shadow_mm / law.least_mm
    )
    return ti.min(fade, 1.0)


@ti.func
def hidden_share(
    frame,
    start,
    way,
    reach,
    radius,
    tree: ti.template(),
    skin: ti.template(),
    placed: ti.template(),
):
    """Share of a light's disc that the moved patch hides; `shading.hidden_share` is the twin."""
    helper = tm.vec3(1.0, 0.0, 0.0)
    if ti.abs(way.x) > 0.7:
        helper = tm.vec3(0.0, 1.0, 0.0)
    across = way.cross(helper).normalized()
    along = way.cross(across)
    hidden, parts = 0, 0
    for point in range(8):
        if point < 4 or (hidden > 0 and hidden < parts):
            parts += 1
            out = OUTER_POINTS * radius
            turn = 0.5 * tm.pi * point
            if point >= 4:
                out = INNER_POINTS * radius
                turn += 0.25 * tm.pi
            line = reach * way + out * (ti.cos(turn) * across + ti.sin(turn) * along)
            length = line.norm()
            blocker, _far = nearest(frame, start, line / length, length, True, tree, skin, placed)
            if blocker >= 0:
                hidden += 1
    return hidden / ti.cast(parts, ti.f32)


@ti.kernel
def shade_vertices(
    count: ti.i32,
    vertex_list: Integers,
    skin: Skin,
    posed: Posed,
    lights: Lights,
    scattered: ScatteredLight,
    law: Law,
    shadows: ti.i32,
    tree: Tree,
    radiance: Vectors,
):
    """Radiance of each vertex on the list."""
    vertices = skin.points.shape[0]
    for entry in range(count):
        at = vertex_list[entry]
        frame, vertex = at // vertices, at % vertices
        here, was = posed.placed[at], skin.points[vertex]
        inward, view = -posed.turned[at], posed.to_camera[at]
        total = law.ambient
        if law.way_of_lighting >= HYBRID:
            total += scattered_to(vertex, inward, scattered)
        if law.way_of_lighting < TABLE:
            moved = share_moved((here - was).norm(), law)
            depth = moved
            if shadows == EVERYWHERE:
                depth = 1.0
            if shadows == NO_SHADOWS or law.way_of_lighting == FIELD:
                depth = 0.0
            for number in range(lights.led.shape[0]):
                if lights.light[vertex, number].w > 0.0:
                    way, reach, received = arriving(
                        law.way_of_lighting, was, here, vertex, number, lights
                    )
                    returned = returned_share(way, view, inward, law)
                    if returned > 0.0 and depth > 0.0:
                        start = here + SKIN_OFFSET_MM * inward
                        # Skin at rest is shadowed from afar: penumbras there are wide enough.
                        finest = moved * law.finest_shadow * reach
                        radius = ti.max(lights.led_radius[number], finest)
                        returned *= 1.0 - depth * hidden_share(
                            frame, start, way, reach, radius, tree, skin, posed.placed
                        )
                    total += returned * received * lights.led_rgb[number]
        radiance[at] = total
