"""Taichi functions of fast contact: poses, the object's distance along the skin, the compliance."""

# Taichi reads annotations and operators in its own way.
# pyright: reportInvalidTypeForm=false, reportGeneralTypeIssues=false, reportIndexIssue=false

import math

import taichi as ti
import taichi.math as tm

from sim.contact.objects.shape_distance_functions import signed_distance

TILT = 0.5
"""Largest angle between the push and the inward normal of the skin [rad]: a rounded edge would push
a node of a linear skin sideways until it escapes."""
LEAST_ALONG = 0.2
"""Cosine below which a distance is not counted along another direction."""
_COS, _SIN = math.cos(TILT), math.sin(TILT)


@ti.func
def origin_of(poses: ti.template(), press):
    """Origin of an object's frame [mm]."""
    return tm.vec3(poses[7 * press], poses[7 * press + 1], poses[7 * press + 2])


@ti.func
def rotation_of(poses: ti.template(), press):
    """Rotation from an object's frame to the sensor's."""
    w, x = poses[7 * press + 3], poses[7 * press + 4]
    y, z = poses[7 * press + 5], poses[7 * press + 6]
    return ti.Matrix(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


@ti.func
def distance_at(place, origin, rotation, thing: ti.template()):
    """Distance of an object [mm] and its gradient in the sensor's frame, a unit vector."""
    seat = tm.vec3(thing.seats[0], thing.seats[1], thing.seats[2])
    size = ti.Vector([thing.sizes[k] for k in range(8)])
    counts = tm.ivec3(thing.sample_counts[0], thing.sample_counts[1], thing.sample_counts[2])
    there = rotation.transpose() @ (place - origin) - seat
    away, gradient = signed_distance(there, thing.shape, size, thing.coefficients, counts, 0)
    way = rotation @ gradient
    return away, way / ti.max(way.norm(), 1e-9)


@ti.func
def clamped(away, way, inward):
    """The distance along a direction at most `TILT` off the inward normal, and that direction."""
    cosine = way.dot(inward)
    side = way - cosine * inward
    length = side.norm()
    if length > _SIN:
        turned = _COS * inward + _SIN * side / length
        along = way.dot(turned)
        if along > LEAST_ALONG:
            away /= along
            way = turned
    return away, way


@ti.func
def block_of(skin: ti.template(), pair):
    """Displacement of a row's node by a unit force on its neighbour [mm/N]."""
    found = ti.Matrix.zero(ti.f32, 3, 3)
    for i, j in ti.static(ti.ndrange(3, 3)):
        found[i, j] = skin.row_blocks[9 * pair + 3 * i + j]
    return found


@ti.func
def decoupled(block, moved, pushed):
    """A block without the coupling of the responses along the normal and across it.

    A linear skin flows sideways under a dent far more than a true one does. `moved` and `pushed`
    are the normals of the node that moves and of the one that is pushed: across them each counts
    for its own node, along them the mean of both (tried: both own, both mean, the other way round).
    """
    normal = (moved + pushed) / ti.max((moved + pushed).norm(), 1e-6)
    along = normal.dot(block @ normal)
    across = block - moved.outer_product(moved @ block)
    return across - (across @ pushed).outer_product(pushed) + along * normal.outer_product(normal)


@ti.func
def turned(vector, before, after):
    """A vector turned as the unit vector `before` is to come to `after`, the shortest way."""
    both = before + after
    share = both.dot(vector) / (1.0 + before.dot(after))
    return vector - share * both + 2.0 * before.dot(vector) * after


@ti.func
def wait(lanes: ti.template()):
    """Let the threads of a press meet."""
    if ti.static(lanes > 1):
        ti.simt.block.sync()


@ti.func
def share_of(count, lane, lanes: ti.template()):
    """How many of so many entries a thread has: lane, lane + lanes ..."""
    return (count - lane + lanes - 1) // lanes
