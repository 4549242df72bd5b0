"""Taichi kernels beside the substep: sums over cases, and copies of a case's part of an array.

Sums run in chunks of rows that never span two cases, and in a fixed order.
"""

# Taichi reads annotations and operators in its own way.
# pyright: reportInvalidTypeForm=false, reportGeneralTypeIssues=false, reportIndexIssue=false

import taichi as ti

from sim.contact.engine.bundles import Floats, Integers
from sim.contact.grid.layout import FREE, HELD_STILL, TOUCHED

Doubles = ti.types.ndarray(dtype=ti.f64, ndim=1)


@ti.kernel
def node_sums(forces: Floats, powers: Floats, fixed: Integers, bounds: Integers, partial: Doubles):
    """Per chunk of nodes: work, inertia, squared free force, and the free force by component."""
    for chunk in range(bounds.shape[0] // 2):
        total = ti.Vector([0.0] * 6, dt=ti.f64)
        for node in range(bounds[2 * chunk], bounds[2 * chunk + 1]):
            total[0] += powers[2 * node]
            total[1] += powers[2 * node + 1]
            if fixed[node] == 0:
                for c in ti.static(range(3)):
                    force = ti.cast(forces[3 * node + c], ti.f64)
                    total[2] += force * force
                    total[3 + c] += force
        for c in ti.static(range(6)):
            partial[6 * chunk + c] = total[c]


@ti.kernel
def surface_sums(
    point_forces: Floats, held: Integers, bounds: Integers, first: ti.i32, partial: Doubles
):
    """Per chunk of surface points: contact force, then holding force, by component.

    The sums of the first chunk go to row `first`.
    """
    for chunk in range(bounds.shape[0] // 2):
        total = ti.Vector([0.0] * 6, dt=ti.f64)
        for point in range(bounds[2 * chunk], bounds[2 * chunk + 1]):
            for c in ti.static(range(3)):
                if held[point] != HELD_STILL:
                    total[c] += point_forces[3 * point + c]
                else:
                    total[3 + c] += point_forces[3 * point + c]
        for c in ti.static(range(6)):
            partial[6 * (first + chunk) + c] = total[c]


@ti.kernel
def fold(rows: Doubles, bounds: Integers, sums: Doubles):
    """Per chunk of rows of six numbers: their sums, in the order of the rows."""
    for chunk in range(bounds.shape[0] // 2):
        total = ti.Vector([0.0] * 6, dt=ti.f64)
        for row in range(bounds[2 * chunk], bounds[2 * chunk + 1]):
            for c in ti.static(range(6)):
                total[c] += rows[6 * row + c]
        for c in ti.static(range(6)):
            sums[6 * chunk + c] = total[c]


@ti.kernel
def copy_out(source: Floats, target: Floats, first: ti.i32, count: ti.i32):
    """Copy entries `first` and following of a long array to the start of a short one."""
    for i in range(count):
        target[i] = source[first + i]


@ti.kernel
def copy_whole_out(source: Integers, target: Floats, first: ti.i32, count: ti.i32):
    """The same of whole numbers, small enough for single precision to hold them."""
    for i in range(count):
        target[i] = ti.cast(source[first + i], ti.f32)


@ti.kernel
def copy_in(source: Floats, target: Floats, first: ti.i32, count: ti.i32):
    """Copy the start of a short array to entries `first` and following of a long one."""
    for i in range(count):
        target[first + i] = source[i]


@ti.kernel
def copy_back(source: Floats, target: Floats, first: ti.i32, count: ti.i32):
    """Copy entries `first` and following to the same place of another array."""
    for i in range(count):
        target[first + i] = source[first + i]


@ti.kernel
def rest(
    velocity: Floats,
    states: Integers,
    first_node: ti.i32,
    nodes: ti.i32,
    first_point: ti.i32,
    points: ti.i32,
):
    """Stop a case's nodes and forget the anchors of the frame under way."""
    for i in range(3 * nodes):
        velocity[3 * first_node + i] = 0.0
    for i in range(points):
        if states[first_point + i] == TOUCHED:
            states[first_point + i] = FREE
