"""Taichi kernels of a press on a soft object: the membrane's points meet a body that deforms too.

Case 0 of the batch is the membrane, case 1 the object on a lattice of its own, in its body frame at
the start of the press. A point of the membrane at q (in that frame) lies at the place X of the
undeformed object for which X + u(X) = q; Newton's iteration finds it from where the rigid object
would have it. With the undeformed object's signed distance phi and its deformation gradient F the
penalty energy k phi(X)^2 / 2 gives

    force on the membrane -k phi F^-T grad phi, on node n of the object the opposite times w_n(X),

so action and reaction are equal. Friction is that of the rigid object with anchors in the
undeformed object. Nodes of the object gather integers (2^-36 N): their sum does not depend on its
order.
`partner` holds the origin of the object's body from the target at the start, its rotation body to
sensor by rows, and 1 / cell edge: 13 floats. The plain twins are in `meeting` and `reference`.
"""

# Taichi reads annotations and operators in its own way.
# pyright: reportInvalidTypeForm=false, reportGeneralTypeIssues=false, reportIndexIssue=false, reportOptionalCall=false

import taichi as ti

from sim.contact.engine.cell_kernel import cell_pass, entry
from sim.contact.engine.kernels import Floats, Integers, node_pass
from sim.contact.engine.point_functions import line_weights
from sim.contact.grid.layout import (
    FREE,
    FRICTION,
    HELD,
    IDLE,
    LOCAL,
    MEETS_SOFT,
    MODE,
    POINT,
    STIFFNESS,
    TOUCHED,
)
from sim.contact.region.domain import BLOCK
from sim.contact.soft.meeting_functions import (
    MEMBRANE,
    NOWHERE,
    OBJECT,
    friction_slip,
    meet,
    point_place,
)

QUANTUM_N = 2.0**-36
"""Unit in which forces on the object are summed."""
Sums = ti.types.ndarray(dtype=ti.i64, ndim=1)


@ti.func
def soft_pass(
    displacement: ti.template(), rows: ti.template(), cell_cases: ti.template(),
    slots: ti.template(), starts: ti.template(), points: ti.template(),
    held: ti.template(), anchors: ti.template(), states: ti.template(),
    point_forces: ti.template(), poses: ti.template(), numbers: ti.template(),
    choices: ti.template(), coefficients: ti.template(), partner: ti.template(),
    cell_map: ti.template(), extents: ti.template(), object_forces: ti.template(), cells, row,
):  # fmt: skip
    """Contact of the membrane's points with the object, on both."""
    for cell in range(cells):
        if cell_cases[cell] == MEMBRANE and choices[MODE] != IDLE:
            for point in range(starts[cell], starts[cell + 1]):
                if held[point] == MEETS_SOFT:
                    at = point_place(displacement, rows, points, cell, point)
                    place, hit, deformation, distance, gradient = meet(
                        at, row, displacement, rows, poses, numbers, choices, coefficients,
                        partner, cell_map, extents,
                    )  # fmt: skip
                    if hit != NOWHERE and distance < 0.0:
                        if states[point] == FREE:
                            states[point] = TOUCHED
                            for c in ti.static(range(3)):
                                anchors[3 * point + c] = place[c]
                        anchor = ti.Vector([anchors[3 * point + c] for c in range(3)])
                        steep = deformation.inverse().transpose() @ gradient
                        limit = -numbers[FRICTION] * distance * steep.norm()
                        slip = friction_slip(place, anchor, deformation, gradient, limit)
                        push = -points[POINT * point + STIFFNESS] * (
                            distance * steep + deformation @ slip
                        )
                        _give_object(push, place, hit, rows, object_forces, partner[12])
                        turned = ti.Matrix(
                            [[partner[3 + 3 * r + c] for c in range(3)] for r in range(3)]
                        )
                        force = turned @ push
                        _give_membrane(force, cell, point, slots, points)
                        for c in ti.static(range(3)):
                            point_forces[3 * point + c] = force[c]
                    elif states[point] == TOUCHED:
                        states[point] = FREE


@ti.func
def _give_object(
    push, place, cell, rows: ti.template(), object_forces: ti.template(), inverse_edge
):
    """Take a force from the object's nodes, in whole quanta."""
    cells = place * inverse_edge
    local = cells - ti.floor(cells + 0.5)
    x, y, z = line_weights(local[0]), line_weights(local[1]), line_weights(local[2])
    for n in ti.static(range(27)):
        weight = x[n // 9] * y[n // 3 % 3] * z[n % 3]
        base = 3 * (rows[entry(cell, n // 3, 9)] + n % 3)
        for c in ti.static(range(3)):
            quanta = ti.cast(-weight * push[c], ti.f64) / QUANTUM_N
            ti.atomic_add(object_forces[base + c], ti.cast(ti.round(quanta), ti.i64))


@ti.func
def _give_membrane(force, cell, point, slots: ti.template(), points: ti.template()):
    """Add a force to the slots of the point's cell, which no other thread writes."""
    x, y, z = (
        line_weights(points[POINT * point + LOCAL]),
        line_weights(points[POINT * point + LOCAL + 1]),
        line_weights(points[POINT * point + LOCAL + 2]),
    )
    base = entry(cell, 0, 81)
    for n in ti.static(range(27)):
        weight = x[n // 9] * y[n // 3 % 3] * z[n % 3]
        for c in ti.static(range(3)):
            slots[base + (3 * n + c) * BLOCK] += weight * force[c]


@ti.func
def deposit_pass(
    slots: ti.template(), node_slots: ti.template(), node_cases: ti.template(),
    object_forces: ti.template(), nothing, nodes,
):  # fmt: skip
    """Put what the object's nodes gathered into one of the slots that belong to each."""
    for node in range(nodes):
        if node_cases[node] == OBJECT:
            slot = nothing
            for place in range(27):
                if slot == nothing:
                    slot = node_slots[entry(node, place, 27)]
            for c in ti.static(range(3)):
                gathered = object_forces[3 * node + c]
                if gathered != 0 and slot != nothing:
                    slots[slot + c * BLOCK] += ti.cast(gathered * QUANTUM_N, ti.f32)
                object_forces[3 * node + c] = 0


def _make_substep(linear):
    """The kernel of one substep for a material law; each law is compiled when first used."""

    @ti.kernel
    def soft_substep(
        displacement: Floats, velocity: Floats, forces: Floats, slots: Floats, rows: Integers,
        volumes: Floats, moduli: Floats, cell_cases: Integers, node_slots: Integers,
        node_cases: Integers, masses: Floats, fixed: Integers, powers: Floats, starts: Integers,
        points: Floats, held: Integers, goals: Floats, anchors: Floats, states: Integers,
        point_forces: Floats,
        poses: Floats, numbers: Floats, choices: Integers, coefficients: Floats, partner: Floats,
        cell_map: Integers, extents: Integers, object_forces: Sums, cases: ti.i32, step: ti.i32,
    ):  # fmt: skip
        cells, nodes = cell_cases.shape[0], node_cases.shape[0]
        nothing = slots.shape[0] - 81 * BLOCK
        cell_pass(
            displacement, rows, volumes, moduli, cell_cases, slots, starts, points, held, goals,
            anchors, states, point_forces, poses, numbers, choices, coefficients, cells, cases,
            step, linear,
        )  # fmt: skip
        soft_pass(
            displacement, rows, cell_cases, slots, starts, points, held, anchors, states,
            point_forces, poses, numbers, choices, coefficients, partner, cell_map, extents,
            object_forces, cells, step * cases + MEMBRANE,
        )  # fmt: skip
        deposit_pass(slots, node_slots, node_cases, object_forces, nothing, nodes)
        node_pass(
            displacement, velocity, forces, slots, node_slots, node_cases, masses, fixed, powers,
            numbers, choices, nodes,
        )  # fmt: skip

    return soft_substep


SOFT_SUBSTEP = {linear: _make_substep(linear) for linear in (False, True)}
"""By whether the law is linear: a substep of a membrane and a soft object."""


@ti.kernel
def commit_soft_anchors(
    displacement: Floats, rows: Integers, cell_cases: Integers, starts: Integers,
    points: Floats, held: Integers, anchors: Floats, states: Integers, slips: Floats,
    poses: Floats, numbers: Floats, choices: Integers, coefficients: Floats, partner: Floats,
    cell_map: Integers, extents: Integers,
):  # fmt: skip
    """Close a settled frame: anchors follow the points that slid (`kernels.commit_anchors`)."""
    for cell in range(cell_cases.shape[0]):
        if cell_cases[cell] == MEMBRANE:
            for point in range(starts[cell], starts[cell + 1]):
                if held[point] == MEETS_SOFT:
                    at = point_place(displacement, rows, points, cell, point)
                    place, hit, deformation, distance, gradient = meet(
                        at, MEMBRANE, displacement, rows, poses, numbers, choices, coefficients,
                        partner, cell_map, extents,
                    )  # fmt: skip
                    if hit != NOWHERE and distance < 0.0 and states[point] != FREE:
                        anchor = ti.Vector([anchors[3 * point + c] for c in range(3)])
                        steep = deformation.inverse().transpose() @ gradient
                        limit = -numbers[FRICTION] * distance * steep.norm()
                        slip = friction_slip(place, anchor, deformation, gradient, limit)
                        normal = gradient / ti.max(gradient.norm(), 1e-9)
                        way = place - slip - anchor
                        slips[point] += (deformation @ (way - way.dot(normal) * normal)).norm()
                        states[point] = HELD
                        for c in ti.static(range(3)):
                            anchors[3 * point + c] = place[c] - slip[c]
                    else:
                        states[point] = FREE
