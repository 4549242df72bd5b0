"""Taichi functions of a press on a soft object: where a point of the membrane meets it.

The plain twin is in `meeting`; `kernels` says which body is which, and what `partner` holds.
"""

# Taichi reads annotations and operators in its own way.
# pyright: reportInvalidTypeForm=false, reportGeneralTypeIssues=false, reportIndexIssue=false, reportOptionalCall=false

import taichi as ti

from sim.contact.engine.cell_kernel import entry
from sim.contact.engine.kernels import point_displacement
from sim.contact.engine.point_functions import body_rotation, line_weights, object_distance
from sim.contact.grid.layout import POINT, POSE

MEMBRANE, OBJECT = 0, 1
"""Cases of the batch."""
NEWTON = 4
"""Iterations for the place in the undeformed object: the last changes it by less than 1e-6 mm."""
NOWHERE = -1
"""Entry of the cell map where the object has no cell."""


@ti.func
def _line_slopes(local):
    """Slopes of `line_weights` by the place in cells."""
    return ti.Vector([local - 0.5, -2.0 * local, local + 0.5])


@ti.func
def _cell_at(place, cell_map: ti.template(), extents: ti.template()):
    """Cell of the object around a place [cells], or NOWHERE."""
    found = NOWHERE
    index = ti.Vector([0, 0, 0])
    inside = True
    for c in ti.static(range(3)):
        index[c] = ti.cast(ti.floor(place[c] + 0.5), ti.i32) - extents[c]
        inside = inside and index[c] >= 0 and index[c] < extents[3 + c]
    if inside:
        found = cell_map[(index[0] * extents[4] + index[1]) * extents[5] + index[2]]
    return found


@ti.func
def _deformed(place, cell, displacement: ti.template(), rows: ti.template(), inverse_edge):
    """Displacement [mm] and its gradient at a place [cells] of the object."""
    local = place - ti.floor(place + 0.5)
    x, y, z = line_weights(local[0]), line_weights(local[1]), line_weights(local[2])
    dx, dy, dz = _line_slopes(local[0]), _line_slopes(local[1]), _line_slopes(local[2])
    moved = ti.Vector([0.0, 0.0, 0.0])
    gradient = ti.Matrix.zero(ti.f32, 3, 3)
    for n in ti.static(range(27)):
        i, j, k = ti.static(n // 9, n // 3 % 3, n % 3)
        base = 3 * (rows[entry(cell, n // 3, 9)] + k)
        nodal = ti.Vector([displacement[base + c] for c in range(3)])
        moved += x[i] * y[j] * z[k] * nodal
        slope = ti.Vector([dx[i] * y[j] * z[k], x[i] * dy[j] * z[k], x[i] * y[j] * dz[k]])
        gradient += nodal.outer_product(slope) * inverse_edge
    return moved, gradient


@ti.func
def _start_place(point_mm, rotation, poses: ti.template(), row):
    """Where the rigid object would have a point [mm from the target], in its body frame."""
    place = point_mm
    for c in ti.static(range(3)):
        place[c] -= poses[POSE * row + c]
    return rotation.transpose() @ place


@ti.func
def meet(
    point_mm,
    row,
    displacement: ti.template(),
    rows: ti.template(),
    poses: ti.template(),
    numbers: ti.template(),
    choices: ti.template(),
    coefficients: ti.template(),
    partner: ti.template(),
    cell_map: ti.template(),
    extents: ti.template(),
):
    """Where a point of the membrane [mm from the target] meets the object.

    Returns place [mm], cell or NOWHERE, deformation gradient, distance and its gradient.
    """
    inverse_edge = partner[12]
    turned = ti.Matrix([[partner[3 + 3 * r + c] for c in range(3)] for r in range(3)])
    origin = ti.Vector([partner[c] for c in range(3)])
    wanted = turned.transpose() @ (point_mm - origin)
    place = _start_place(point_mm, body_rotation(poses, row), poses, row)
    distance, gradient = object_distance(place, numbers, choices, coefficients, MEMBRANE)
    if distance > 0.0:
        # A point that only the deformed object has reached is sought from the skin inward.
        place -= distance * gradient
    cell = _cell_at(place * inverse_edge, cell_map, extents)
    deformation = ti.Matrix.identity(ti.f32, 3)
    for _ in range(NEWTON):
        if cell != NOWHERE:
            moved, slope = _deformed(place * inverse_edge, cell, displacement, rows, inverse_edge)
            deformation = ti.Matrix.identity(ti.f32, 3) + slope
            place -= deformation.inverse() @ (place + moved - wanted)
            cell = _cell_at(place * inverse_edge, cell_map, extents)
    distance, gradient = object_distance(place, numbers, choices, coefficients, MEMBRANE)
    return place, cell, deformation, distance, gradient


@ti.func
def friction_slip(place, anchor, deformation, gradient, limit):
    """Tangential slip in the undeformed object, returned to the friction cone [mm]."""
    normal = gradient / ti.max(gradient.norm(), 1e-9)
    slip = place - anchor
    slip -= slip.dot(normal) * normal
    length = (deformation @ slip).norm()
    if length > limit:
        slip *= limit / length
    return slip


@ti.func
def point_place(
    displacement: ti.template(), rows: ti.template(),
    points: ti.template(), cell, point,
):  # fmt: skip
    """Deformed place of a surface point of the membrane [mm from the target]."""
    place = point_displacement(displacement, rows, points, cell, point)
    for c in ti.static(range(3)):
        place[c] += points[POINT * point + c]
    return place
