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

from sim.optics.light.kernel_types import Vectors
from sim.optics.raster.bundles import Skin, Tree

LEAF = 2
WIDTH = 4
LEVELS = 10
"""Levels that the arrays have room for: 4^11 triangles."""
LOW, HIGH, FLATTEST, STEEPEST = range(4)
"""Corners of a box of places and of one of normals."""
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
def may_leave(way, tree: ti.template(), at):
    """Whether a ray could pass outward through a triangle in a box."""
    return ti.max(way * tree.boxes[at, FLATTEST], way * tree.boxes[at, STEEPEST]).sum() > 0.0


@ti.func
def boxes_of(level, tree: ti.template()):
    """Boxes of a level of each frame."""
    return tree.level_start[level + 1] - tree.level_start[level]


@ti.func
def axes_of(frame, tree: ti.template(), skin: ti.template()):
    """Axes of a frame's boxes, as rows: the last is normal to the skin in the middle of the list.

    Skin is thin: boxes along it are a fraction of the size of boxes at an angle to it.
    """
    last = tm.vec3(0.0, 0.0, 1.0)
    begin, end = tree.list_start[frame], tree.list_start[frame + 1]
    if end > begin:
        middle = tree.face_list[(begin + end) // 2] % skin.faces.shape[0]
        last = skin.normals[skin.faces[middle, 0]]
    side = tm.vec3(1.0, 0.0, 0.0)
    if ti.abs(last.x) > 0.7:
        side = tm.vec3(0.0, 1.0, 0.0)
    first = last.cross(side).normalized()
    second = last.cross(first)
    return ti.Matrix.rows([first, second, last])


@ti.func
def corners_of(face, first, faces: ti.template(), placed: ti.template()):
    """Places of a face's corners in the frame whose vertices begin at `first`."""
    a, b, c = first + faces[face, 0], first + faces[face, 1], first + faces[face, 2]
    return placed[a], placed[b], placed[c]


@ti.kernel
def build_tree(frames: ti.i32, tree: Tree, skin: Skin, placed: Vectors):
    """Boxes of places and of normals, all levels of all frames; empty beyond a frame's list."""
    vertices = skin.points.shape[0]
    for frame, leaf in ti.ndrange(frames, tree.level_start[1]):
        least, most = tm.vec3(NOTHING_MM), tm.vec3(-NOTHING_MM)
        flattest, steepest = tm.vec3(NOTHING_MM), tm.vec3(-NOTHING_MM)
        first = tree.list_start[frame] + leaf * LEAF
        turn = axes_of(frame, tree, skin)
        base = frame * vertices
        for entry in range(first, ti.min(first + LEAF, tree.list_start[frame + 1])):
            face = tree.face_list[entry] % skin.faces.shape[0]
            a, b, c = corners_of(face, base, skin.faces, placed)
            for corner in ti.static((a, b, c)):
                point = turn @ corner
                least, most = ti.min(least, point), ti.max(most, point)
            normal = outward(a, b, c)
            flattest, steepest = ti.min(flattest, normal), ti.max(steepest, normal)
        at = frame * tree.level_start[LEVELS] + leaf
        tree.boxes[at, LOW] = least - MARGIN_MM
        tree.boxes[at, HIGH] = most + MARGIN_MM
        tree.boxes[at, FLATTEST] = flattest
        tree.boxes[at, STEEPEST] = steepest
    for level in ti.static(range(1, LEVELS)):
        for frame, box in ti.ndrange(frames, boxes_of(level, tree)):
            least, most = tm.vec3(NOTHING_MM), tm.vec3(-NOTHING_MM)
            flattest, steepest = tm.vec3(NOTHING_MM), tm.vec3(-NOTHING_MM)
            first = frame * tree.level_start[LEVELS]
            below = tree.level_start[level - 1] + box * WIDTH
            beyond = ti.min(below + WIDTH, tree.level_start[level])
            for child in range(first + below, first + beyond):
                least = ti.min(least, tree.boxes[child, LOW])
                most = ti.max(most, tree.boxes[child, HIGH])
                flattest = ti.min(flattest, tree.boxes[child, FLATTEST])
                steepest = ti.max(steepest, tree.boxes[child, STEEPEST])
            at = first + tree.level_start[level] + box
            tree.boxes[at, LOW] = least
            tree.boxes[at, HIGH] = most
            tree.boxes[at, FLATTEST] = flattest
            tree.boxes[at, STEEPEST] = steepest


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
def meets_box(start, inverse, tree: ti.template(), at, reach):
    """Whether a ray enters a box within `reach`; never an empty one."""
    low, high = tree.boxes[at, LOW], tree.boxes[at, HIGH]
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
    tree: ti.template(),
    skin: ti.template(),
    placed: ti.template(),
):
    """Nearest moved triangle within `reach`, its distance: (-1, reach) if there is none.

    With `any_will_do`, any triangle that the ray leaves the body through. A ray from inside meets
    such a one first, so the rest, which is most of a dent as its lights see it, is passed over.
    """
    found, limit = -1, reach
    top = tree.levels - 1
    base = frame * skin.points.shape[0]
    begin, end = tree.list_start[frame], tree.list_start[frame + 1]
    level, node = top, 0
    going = end > begin
    turn = axes_of(frame, tree, skin)
    turned_start, inverse = turn @ start, inverse_of(turn @ way)
    while going:
        down = False
        at = frame * tree.level_start[LEVELS] + tree.level_start[level] + node
        worth = True
        if ti.static(any_will_do):
            worth = may_leave(way, tree, at)
        if worth and meets_box(turned_start, inverse, tree, at, limit):
            if level > 0:
                level -= 1
                node *= WIDTH
                down = True
            else:
                first = begin + node * LEAF
                for entry in range(first, ti.min(first + LEAF, end)):
                    face = tree.face_list[entry] % skin.faces.shape[0]
                    a, b, c = corners_of(face, base, skin.faces, placed)
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
            while level < top and (node % WIDTH == 0 or node >= boxes_of(level, tree)):
                node = (node + WIDTH - 1) // WIDTH
                level += 1
            if level == top and node >= boxes_of(top, tree):
                going = False
    return found, limit
