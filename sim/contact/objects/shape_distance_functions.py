"""Taichi functions: signed distance of a rigid indenter in its body frame, with its gradient.

Shapes and the meaning of `size` are those of `shape_distance`, the twin in NumPy.
Rounded shapes are a smaller sharp shape, offset outwards by the edge radius.
"""

# Taichi reads annotations and operators in its own way.
# pyright: reportInvalidTypeForm=false, reportIndexIssue=false, reportOptionalCall=false

import taichi as ti

from sim.contact.objects.shape_distance import SEAT
from workbench.core.objects.kind import Shape

SPHERE = int(Shape.SPHERE)
CYLINDER_Z = int(Shape.CYLINDER_Z)
CYLINDER_Y = int(Shape.CYLINDER_Y)
CUBE = int(Shape.CUBE)
CONE = int(Shape.CONE)

_ROOT_HALF = 0.5**0.5
_TINY_MM = 1e-9


@ti.func
def _ball(position, radius, seat):
    """Distance to a ball about (0, 0, -`seat`), without the difference of two long lengths."""
    from_centre = position + ti.Vector([0.0, 0.0, seat])
    length = from_centre.norm()
    excess = position.norm_sqr() + 2.0 * seat * position[2] + (seat - radius) * (seat + radius)
    return excess / ti.max(length + radius, _TINY_MM), from_centre / ti.max(length, _TINY_MM)


@ti.func
def _beyond_ends(z, seat, height):
    """How far a place lies beyond |z + seat| <= height, and on which side; exact at `seat`."""
    below, above = -z - (seat + height), z + (seat - height)
    return ti.max(below, above), ti.select(below > above, -1.0, 1.0)


@ti.func
def _box_profile(rho, z, radius, height, seat):
    """Distance to the rectangle rho <= radius, |z + seat| <= height, and its gradient."""
    over_rho = rho - radius
    over_z, up = _beyond_ends(z, seat, height)
    distance, by_rho, by_z = over_z, 0.0, up
    if over_rho > 0.0 and over_z > 0.0:
        distance = ti.sqrt(over_rho * over_rho + over_z * over_z)
        by_rho, by_z = over_rho / distance, up * over_z / distance
    elif over_rho > over_z:
        distance, by_rho, by_z = over_rho, 1.0, 0.0
    return distance, by_rho, by_z


@ti.func
def _cone_profile(rho, z, rim, top, apex):
    """Distance to the right triangle (0, apex), (rim, top), (0, top), and its gradient."""
    slant = _ROOT_HALF * (rho - (z - apex))
    over = z - top
    distance, by_rho, by_z = slant, _ROOT_HALF, -_ROOT_HALF
    if slant <= 0.0 and over <= 0.0:
        if over > slant:
            distance, by_rho, by_z = over, 0.0, 1.0
    else:
        along = ti.min(ti.max(0.5 * (rho + z - apex), 0.0), rim)
        side = ti.Vector([rho - along, z - apex - along])
        cap = ti.Vector([ti.max(rho - rim, 0.0), over])
        nearest = ti.select(side.norm() < cap.norm(), side, cap)
        length = nearest.norm()
        if length > _TINY_MM:
            distance, by_rho, by_z = length, nearest[0] / length, nearest[1] / length
    return distance, by_rho, by_z


@ti.func
def _box(position, half, seat):
    """Distance to the cube |x|, |y|, |z + seat| <= half, and its gradient."""
    over, side = ti.abs(position) - half, ti.Vector([1.0, 1.0, 1.0])
    for c in ti.static(range(2)):
        side[c] = ti.select(position[c] < 0.0, -1.0, 1.0)
    over[2], side[2] = _beyond_ends(position[2], seat, half)
    outside = ti.max(over, 0.0)
    distance = outside.norm()
    gradient = side * outside / ti.max(distance, _TINY_MM)
    if distance <= _TINY_MM:
        distance = over.max()
        gradient = ti.Vector([0.0, 0.0, 0.0])
        if over[0] >= over[1] and over[0] >= over[2]:
            gradient[0] = side[0]
        elif over[1] >= over[2]:
            gradient[1] = side[1]
        else:
            gradient[2] = side[2]
    return distance, gradient


@ti.func
def _sampled(position, size, coefficients: ti.template(), counts, begin):
    """Quadratic B-spline through samples on a grid; outside it a positive lower bound."""
    inside = ti.Vector([0.0, 0.0, 0.0])
    for c in ti.static(range(3)):
        raw = (position[c] - size[c]) * size[3]
        inside[c] = ti.min(ti.max(raw, 1.5), ti.cast(counts[c], ti.f32) - 2.5)
    nearest = ti.floor(inside + 0.5)
    local = inside - nearest
    base = ti.cast(nearest, ti.i32)
    distance = 0.0
    gradient = ti.Vector([0.0, 0.0, 0.0])
    for i in range(3):
        for j in range(3):
            for k in range(3):
                wx, sx = _line(local[0], i)
                wy, sy = _line(local[1], j)
                wz, sz = _line(local[2], k)
                row = (base[0] + i - 1) * counts[1] + base[1] + j - 1
                value = coefficients[begin + row * counts[2] + base[2] + k - 1]
                distance += value * wx * wy * wz
                gradient += value * ti.Vector([sx * wy * wz, wx * sy * wz, wx * wy * sz])
    gradient *= size[3]
    beyond = ti.Vector([0.0, 0.0, 0.0])
    for c in ti.static(range(3)):
        beyond[c] = position[c] - size[c] - inside[c] / size[3]
    far = beyond.norm()
    if far > 1e-4:
        distance = ti.max(far, distance - far)
    return distance, gradient


@ti.func
def _line(local, node):
    """Weight and slope of node 0, 1 or 2 of a quadratic B-spline at `local` in [-1/2, 1/2]."""
    weight, slope = 0.75 - local * local, -2.0 * local
    if node == 0:
        weight, slope = 0.5 * (0.5 - local) ** 2, local - 0.5
    elif node == 2:
        weight, slope = 0.5 * (0.5 + local) ** 2, local + 0.5
    return weight, slope


@ti.func
def signed_distance(position, shape, size, coefficients: ti.template(), counts, begin):
    """Signed distance [mm] and its gradient at a position in the body frame.

    `size` and `counts` are vectors; the object's own coefficients start at `begin`.
    """
    distance, gradient = _ball(position, size[0], size[SEAT])
    if shape == CYLINDER_Z or shape == CYLINDER_Y or shape == CONE:
        axial, first, second = position[2], position[0], position[1]
        if shape == CYLINDER_Y:
            axial, first, second = position[1], position[2], position[0]
        rho = ti.sqrt(first * first + second * second)
        by_rho, by_z = 0.0, 0.0
        if shape == CONE:
            distance, by_rho, by_z = _cone_profile(rho, axial, size[0], size[1], size[3])
        else:
            distance, by_rho, by_z = _box_profile(rho, axial, size[0], size[1], size[SEAT])
        distance -= size[2]
        scale = by_rho / ti.max(rho, _TINY_MM)
        gradient = ti.Vector([first * scale, second * scale, by_z])
        if shape == CYLINDER_Y:
            gradient = ti.Vector([second * scale, by_z, first * scale])
    elif shape == CUBE:
        distance, gradient = _box(position, size[0], size[SEAT])
        distance -= size[2]
    elif shape != SPHERE:
        distance, gradient = _sampled(position, size, coefficients, counts, begin)
    return distance, gradient
