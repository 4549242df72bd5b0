"""Taichi kernel of the megakernel driver: one thread follows one photon from end to end.

The tree of boxes is walked nearer child first. A bit trail remembers at which levels the farther
child still waits, so no stack is needed. Source: Laine, Restart trail for stackless BVH traversal,
HPG 2010; a full binary tree lets it go up by halving the node's number.
"""

# Taichi reads annotations and operators in its own way.
# pyright: reportInvalidTypeForm=false, reportGeneralTypeIssues=false, reportIndexIssue=false
# pyright: reportCallIssue=false, reportAttributeAccessIssue=false

import taichi as ti
import taichi.math as tm

from sim.optics.transport.bundles import Books, Boxes, Lamps, SceneArrays
from sim.optics.transport.constants import EVENTS, FLYING
from sim.optics.transport.event_functions import Hit, Turn, begin, happen

FAR = 1e9
"""Further than anything [mm]."""
NEAR_MM = 1e-5
"""Nearest hit [mm]; rays begin well off their surface."""
EDGE = 1e-6
"""Barycentric slack, so that no ray slips between two triangles."""


@ti.func
def _enters(
    origin: tm.vec3, inverse: tm.vec3, low: tm.vec3, high: tm.vec3, nearest: ti.f32
) -> ti.f32:
    """Distance at which a ray enters a box, FAR if it does not before `nearest`."""
    a, b = (low - origin) * inverse, (high - origin) * inverse
    first, last = ti.min(a, b), ti.max(a, b)
    enter = ti.max(first.x, first.y, first.z, 0.0)
    leave = ti.min(last.x, last.y, last.z)
    return enter if enter <= leave and enter < nearest else FAR


@ti.func
def first_hit(
    origin: tm.vec3, direction: tm.vec3, boxes: ti.template(), scene: ti.template()
) -> Hit:
    """The nearest triangle that a ray meets."""
    inverse = tm.vec3(0.0)
    for k in ti.static(range(3)):
        # A zero component would make NaN where the origin lies on a box's side.
        inverse[k] = 1.0 / (
            direction[k]
            if ti.abs(direction[k]) > 1e-12
            else ti.select(direction[k] < 0, -1e-12, 1e-12)
        )
    leaves = boxes.starts.shape[0] - 1
    nearest, face, hit_u, hit_v = FAR, -1, 0.0, 0.0
    node = 1
    trail = ti.u32(0)
    walking = 1
    while walking == 1:
        up = 1
        if node < leaves:
            left, right = 2 * node, 2 * node + 1
            enter_left = _enters(origin, inverse, boxes.lower[left], boxes.upper[left], nearest)
            enter_right = _enters(origin, inverse, boxes.lower[right], boxes.upper[right], nearest)
            if ti.min(enter_left, enter_right) < FAR:
                up = 0
                node = left if enter_left <= enter_right else right
                both = ti.max(enter_left, enter_right) < FAR
                trail = (trail << ti.u32(1)) | ti.cast(both, ti.u32)
        else:
            for k in range(boxes.starts[node - leaves], boxes.starts[node - leaves + 1]):
                corners = scene.faces[boxes.order[k]]
                a = scene.points[corners[0]]
                edge_1 = scene.points[corners[1]] - a
                edge_2 = scene.points[corners[2]] - a
                across = direction.cross(edge_2)
                scale = edge_1.dot(across)
                if ti.abs(scale) > 1e-12:
                    offset = origin - a
                    turned = offset.cross(edge_1)
                    u = offset.dot(across) / scale
                    v = direction.dot(turned) / scale
                    distance = edge_2.dot(turned) / scale
                    inside = u >= -EDGE and v >= -EDGE and u + v <= 1.0 + EDGE
                    if inside and distance > NEAR_MM and distance < nearest:
                        nearest, face, hit_u, hit_v = distance, boxes.order[k], u, v
        if up == 1:
            if trail == ti.u32(0):
                walking = 0
            else:
                while (trail & ti.u32(1)) == ti.u32(0):
                    trail = trail >> ti.u32(1)
                    node = node >> 1
                node = node ^ 1
                trail = trail ^ ti.u32(1)
    return Hit(face=face, u=hit_u, v=hit_v)


@ti.kernel
def follow_all(
    gather: ti.template(),
    first: ti.i64,
    count: ti.i32,
    seed: ti.i32,
    boxes: Boxes,
    scene: SceneArrays,
    lamps: Lamps,
    books: Books,
):
    """Follow photons `first` to `first + count` to their ends."""
    for row in range(count):
        number = first + row
        photon = begin(number, seed, lamps)
        event = 0
        while photon.fate == FLYING and event < EVENTS:
            hit = first_hit(photon.origin, photon.direction, boxes, scene)
            turn = Turn(number=number, event=event, seed=seed)
            photon = happen(gather, photon, turn, hit, scene, lamps, books)
            event += 1
