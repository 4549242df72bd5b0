"""Rays against the triangles that moved: an implicit tree over a list in a fixed order.

Triangles are numbered once along a space-filling curve (`tree.order_of_faces`), so those that
moved, in ascending order, still lie beside each other. `LEAF` successive ones make a leaf, `WIDTH`
successive boxes the box above them, until at most `WIDTH` remain. There is nothing to sort or link
per frame, and results do not depend on threads: a shadow is an or, the nearest hit a minimum.
"""

# Taichi reads annotations and operators in its own way.
# pyright: reportInvalidTypeForm=false, reportGeneralTypeIssues=false, reportIndexIssue=false

import taichi as ti
import taichi.math as tm

from sim.optics.light.kernel_types import IntegerRows, Integers, Vectors

LEAF = 2
WIDTH = 4
LEVELS = 10
"""Levels that the arrays have room for: 4^11 triangles."""
NOTHING_MM = 1e9
MARGIN_MM = 1e-4
"""Boxes are this much larger, so that rounding cannot cut a triangle off [mm]."""
BARELY = 1e-5
"""Share of a triangle by which it reaches over its edge [1]: no ray slips between two."""


@ti.func
def outward(a, b, c):
    """Unit normal of a triangle; 0 where it has none."""
    normal = (b - a).cross(c - a)
    return normal / ti.max(normal.norm(), 1e-20)


@ti.func
def may_leave(way, least, most):
    """Whether a ray could pass outward through a triangle whose normal lies in a box."""
    return ti.max(way * least, way * most).sum() > 0.0


@ti.func
def axes_of(
    frame,
    list_start: ti.template(),
    face_list: ti.template(),
    faces: ti.template(),
    normals: ti.template(),
):
    """Axes of a frame's boxes, as rows: the last is normal to the skin in the middle of the list.

    Skin is thin: boxes along it are a fraction of the size of boxes at an angle to it.
    """
    last = tm.vec3(0.0, 0.0, 1.0)
    if list_start[frame + 1] > list_start[frame]:
        middle = face_list[(list_start[frame] + list_start[frame + 1]) // 2] % faces.shape[0]
        last = normals[faces[middle, 0]]
    side = tm.vec3(1.0, 0.0, 0.0)
    if ti.abs(last.x) > 0.7:
        side = tm.vec3(0.0, 1.0, 0.0)
    first = last.cross(side).normalized()
    second = last.cross(first)
    return ti.Matrix.rows([first, second, last])


@ti.kernel
def build_tree(
    frames: ti.i32,
    vertices: ti.i32,
    levels: ti.i32,
    boxes: ti.i32,
    level_start: Integers,
    level_count: Integers,
    list_start: Integers,
    face_list: Integers,
    faces: IntegerRows,
    normals: Vectors,
    placed: Vectors,
    low: Vectors,
    high: Vectors,
    normal_low: Vectors,
    normal_high: Vectors,
):
    """Boxes of places and of normals, all levels of all frames; empty beyond a frame's list."""
    for frame, leaf in ti.ndrange(frames, level_count[0]):
        least, most = tm.vec3(NOTHING_MM), tm.vec3(-NOTHING_MM)
        flattest, steepest = tm.vec3(NOTHING_MM), tm.vec3(-NOTHING_MM)
        first = list_start[frame] + leaf * LEAF
        turn = axes_of(frame, list_start, face_list, faces, normals)
        for entry in range(first, ti.min(first + LEAF, list_start[frame + 1])):
            face = face_list[entry] % faces.shape[0]
            for corner in ti.static(range(3)):
                point = turn @ placed[frame * vertices + faces[face, corner]]
                least, most = ti.min(least, point), ti.max(most, point)
            base = frame * vertices
            a, b, c = faces[face, 0], faces[face, 1], faces[face, 2]
            normal = outward(placed[base + a], placed[base + b], placed[base + c])
            flattest, steepest = ti.min(flattest, normal), ti.max(steepest, normal)
        normal_low[frame * boxes + leaf] = flattest
        normal_high[frame * boxes + leaf] = steepest
        low[frame * boxes + leaf] = least - MARGIN_MM
        high[frame * boxes + leaf] = most + MARGIN_MM
    for level in ti.static(range(1, LEVELS)):
        for frame, box in ti.ndrange(frames, level_count[level]):
            least, most = tm.vec3(NOTHING_MM), tm.vec3(-NOTHING_MM)
            flattest, steepest = tm.vec3(NOTHING_MM), tm.vec3(-NOTHING_MM)
            below = frame * boxes + level_start[level - 1]
            last = ti.min((box + 1) * WIDTH, level_count[level - 1])
            for child in range(box * WIDTH, last):
                least = ti.min(least, low[below + child])
                most = ti.max(most, high[below + child])
                flattest = ti.min(flattest, normal_low[below + child])
                steepest = ti.max(steepest, normal_high[below + child])
            normal_low[frame * boxes + level_start[level] + box] = flattest
            normal_high[frame * boxes + level_start[level] + box] = steepest
            low[frame * boxes + level_start[level] + box] = least
            high[frame * boxes + level_start[level] + box] = most


@ti.func
def meet(start: tm.vec3, way: tm.vec3, a: tm.vec3, b: tm.vec3, c: tm.vec3):
    """Distance along a ray of unit direction to a triangle, -1 for a miss, and two weights.

    Corners are taken relative to the ray: with a' = a - start - (..) way perpendicular to it, the
    weights are as way . (b' x c'); neighbours share the term of their edge: no ray slips through.
    """
    a_off, b_off, c_off = a - start, b - start, c - start
    a_far, b_far, c_far = a_off.dot(way), b_off.dot(way), c_off.dot(way)
    a_off -= a_far * way
    b_off -= b_far * way
    c_off -= c_far * way
    first = way.dot(b_off.cross(c_off))
    second = way.dot(c_off.cross(a_off))
    third = way.dot(a_off.cross(b_off))
    total = first + second + third
    distance, v, w = -1.0, 0.0, 0.0
    if ti.abs(total) > 1e-12:
        u = first / total
        v = second / total
        w = third / total
        if u >= -BARELY and v >= -BARELY and w >= -BARELY:
            distance = u * a_far + v * b_far + w * c_far
    return distance, v, w


@ti.func
def meets_box(start, inverse, low, high, reach):
    """Whether a ray enters a box within `reach`; never an empty one."""
    near = (low - start) * inverse
    far = (high - start) * inverse
    enter = ti.max(ti.min(near, far).max(), 0.0)
    leave = ti.min(ti.max(near, far).min(), reach)
    return low.x <= high.x and enter <= leave


@ti.func
def inverse_of(way):
    """1 / direction, finite where a part of it is 0."""
    inverse = tm.vec3(0.0)
    for axis in ti.static(range(3)):
        part = way[axis]
        if ti.abs(part) < 1e-9:
            part = 1e-9
        inverse[axis] = 1.0 / part
    return inverse


@ti.func
def nearest(
    frame,
    start: tm.vec3,
    way: tm.vec3,
    reach: ti.f32,
    any_will_do: ti.template(),
    levels: ti.i32,
    boxes: ti.i32,
    vertices: ti.i32,
    level_start: ti.template(),
    level_count: ti.template(),
    list_start: ti.template(),
    face_list: ti.template(),
    faces: ti.template(),
    normals: ti.template(),
    placed: ti.template(),
    low: ti.template(),
    high: ti.template(),
    normal_low: ti.template(),
    normal_high: ti.template(),
):
    """Nearest moved triangle within `reach`, its distance: (-1, reach) if there is none.

    With `any_will_do`, any triangle that the ray leaves the body through. A ray from inside meets
    such a one first, so the rest, which is most of a dent as its lights see it, is passed over.
    """
    found, limit = -1, reach
    top = levels - 1
    level, node = top, 0
    going = list_start[frame + 1] > list_start[frame]
    turn = axes_of(frame, list_start, face_list, faces, normals)
    turned_start, inverse = turn @ start, inverse_of(turn @ way)
    while going:
        down = False
        at = frame * boxes + level_start[level] + node
        worth = True
        if ti.static(any_will_do):
            worth = may_leave(way, normal_low[at], normal_high[at])
        if worth and meets_box(turned_start, inverse, low[at], high[at], limit):
            if level > 0:
                level -= 1
                node *= WIDTH
                down = True
            else:
                first = list_start[frame] + node * LEAF
                for entry in range(first, ti.min(first + LEAF, list_start[frame + 1])):
                    face = face_list[entry] % faces.shape[0]
                    base = frame * vertices
                    a = placed[base + faces[face, 0]]
                    b = placed[base + faces[face, 1]]
                    c = placed[base + faces[face, 2]]
                    distance, _v, _w = meet(start, way, a, b, c)
                    counts = True
                    if ti.static(any_will_do):
                        counts = (b - a).cross(c - a).dot(way) > 0.0
                    if counts and distance >= 0.0 and distance < limit:
                        found, limit = face, distance
                if ti.static(any_will_do):
                    going = found < 0
        if not down:
            node += 1
            while level < top and (node % WIDTH == 0 or node >= level_count[level]):
                node = (node + WIDTH - 1) // WIDTH
                level += 1
            if level == top and node >= level_count[top]:
                going = False
    return found, limit
