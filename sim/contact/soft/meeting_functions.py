"""Taichi functions of a press on a soft object: where a point of the membrane meets it.

The plain twin is in `meeting`; `kernels` says which body is which.
"""

# Taichi reads annotations and operators in its own way.
# pyright: reportInvalidTypeForm=false, reportGeneralTypeIssues=false, reportIndexIssue=false, reportOptionalCall=false

from typing import NamedTuple

import taichi as ti

from sim.contact.engine.bundles import Floats, Integers
from sim.contact.engine.cell_kernel import entry
from sim.contact.engine.point_functions import body_rotation, line_weights, object_distance
from sim.contact.engine.surface_kernel import point_displacement
from sim.contact.grid.layout import POINT, POSE

MEMBRANE, OBJECT = 0, 1
"""Cases of the batch."""
NEWTON = 4
"""Iterations for the place in the undeformed object: the last changes it by less than 1e-6 mm."""
NOWHERE = -1
"""Entry of the cell map where the object has no cell."""
Sums = ti.types.ndarray(dtype=ti.i64, ndim=1)


class Partner(NamedTuple):
    """The object that the membrane meets: a bundle like those of `engine.bundles`."""

    lattice: Floats
    """Origin of the object's body from the target at the start [mm], its rotation body to sensor
    by rows, and 1 / cell edge [1/mm]: 13."""
    cell_map: Integers
    """Cell at each place of a box of the lattice, or NOWHERE."""
    extents: Integers
    """First place of the box and its size [cells], 6."""
    object_forces: Sums
    """What contact gives to the nodes [quanta], 3 N."""


@ti.func
def _line_slopes(local):
    """Slopes of `line_weights` by the place in cells."""
    return ti.Vector([local - 0.5, -2.0 * local, local + 0.5])


@ti.func
def _cell_at(place, partner: ti.template()):
    """Cell of the object around a place [cells], or NOWHERE."""
    found = NOWHERE
    index = ti.Vector([0, 0, 0])
    inside = True
    for c in ti.static(range(3)):
        index[c] = ti.cast(ti.floor(place[c] + 0.5), ti.i32) - partner.extents[c]
        inside = inside and index[c] >= 0 and index[c] < partner.extents[3 + c]
    if inside:
        line = index[0] * partner.extents[4] + index[1]
        found = partner.cell_map[line * partner.extents[5] + index[2]]
    return found


@ti.func
def _deformed(place, cell, nodes: ti.template(), cells: ti.template(), inverse_edge):
    """Displacement [mm] and its gradient at a place [cells] of the object."""
    local = place - ti.floor(place + 0.5)
    x, y, z = line_weights(local[0]), line_weights(local[1]), line_weights(local[2])
    dx, dy, dz = _line_slopes(local[0]), _line_slopes(local[1]), _line_slopes(local[2])
    moved = ti.Vector([0.0, 0.0, 0.0])
    gradient = ti.Matrix.zero(ti.f32, 3, 3)
    for n in ti.static(range(27)):
        i, j, k = ti.static(n // 9, n // 3 % 3, n % 3)
        base = 3 * (cells.rows[entry(cell, n // 3, 9)] + k)
        nodal = ti.Vector([nodes.displacement[base + c] for c in range(3)])
        moved += x[i] * y[j] * z[k] * nodal
        slope = ti.Vector([dx[i] * y[j] * z[k], x[i] * dy[j] * z[k], x[i] * y[j] * dz[k]])
        gradient += nodal.outer_product(slope) * inverse_edge
    return moved, gradient


@ti.func
def _start_place(point_mm, rotation, cases: ti.template(), row):
    """Where the rigid object would have a point [mm from the target], in its body frame."""
    place = point_mm
    for c in ti.static(range(3)):
        place[c] -= cases.poses[POSE * row + c]
    return rotation.transpose() @ place


@ti.func
def object_rotation(partner: ti.template()):
    """Rotation of the object's body to the sensor at the start."""
    return ti.Matrix([[partner.lattice[3 + 3 * r + c] for c in range(3)] for r in range(3)])


@ti.func
def meet(
    point_mm,
    row,
    nodes: ti.template(),
    cells: ti.template(),
    cases: ti.template(),
    partner: ti.template(),
):
    """Where a point of the membrane [mm from the target] meets the object.

    Returns place [mm], cell or NOWHERE, deformation gradient, distance and its gradient.
    """
    inverse_edge = partner.lattice[12]
    turned = object_rotation(partner)
    origin = ti.Vector([partner.lattice[c] for c in range(3)])
    wanted = turned.transpose() @ (point_mm - origin)
    place = _start_place(point_mm, body_rotation(cases, row), cases, row)
    distance, gradient = object_distance(place, cases, MEMBRANE)
    if distance > 0.0:
        # A point that only the deformed object has reached is sought from the skin inward.
        place -= distance * gradient
    cell = _cell_at(place * inverse_edge, partner)
    deformation = ti.Matrix.identity(ti.f32, 3)
    for _ in range(NEWTON):
        if cell != NOWHERE:
            moved, slope = _deformed(place * inverse_edge, cell, nodes, cells, inverse_edge)
            deformation = ti.Matrix.identity(ti.f32, 3) + slope
            place -= deformation.inverse() @ (place + moved - wanted)
            cell = _cell_at(place * inverse_edge, partner)
    distance, gradient = object_distance(place, cases, MEMBRANE)
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
def point_place(nodes: ti.template(), cells: ti.template(), surface: ti.template(), cell, point):
    """Deformed place of a surface point of the membrane [mm from the target]."""
    place = point_displacement(nodes, cells, surface, cell, point)
    for c in ti.static(range(3)):
        place[c] += surface.points[POINT * point + c]
    return place
