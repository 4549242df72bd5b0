"""Taichi kernels of a press on a soft object: the membrane's points meet a body that deforms too.

Case 0 of the batch is the membrane, case 1 the object on a lattice of its own, in its body frame at
the start of the press. A point of the membrane at q (in that frame) lies at the place X of the
undeformed object for which X + u(X) = q; Newton's iteration finds it from where the rigid object
would have it. With the undeformed object's signed distance phi and its deformation gradient F the
penalty energy k phi(X)^2 / 2 gives

    force on the membrane -k phi F^-T grad phi, on node n of the object the opposite times w_n(X),

so action and reaction are equal. Friction is that of the rigid object with anchors in the
undeformed object. Nodes of the object gather integers (2^-36 N): their sum does not depend on its
order. The plain twins are in `meeting` and `reference`.
"""

# Taichi reads annotations and operators in its own way.
# pyright: reportInvalidTypeForm=false, reportGeneralTypeIssues=false, reportIndexIssue=false, reportOptionalCall=false

import taichi as ti

from sim.contact.engine.bundles import Cases, Cells, Floats, Integers, Nodes, Surface, pack_of
from sim.contact.engine.cell_kernel import cell_pass, entry
from sim.contact.engine.kernels import node_pass
from sim.contact.engine.point_functions import friction_now, line_weights
from sim.contact.engine.surface_kernel import surface_pass
from sim.contact.grid.layout import (
    FREE,
    HELD,
    IDLE,
    LOCAL,
    MEETS_SOFT,
    MODE,
    POINT,
    SLID,
    STIFFNESS,
    TOUCHED,
)
from sim.contact.region.domain import BLOCK
from sim.contact.soft.meeting_functions import (
    MEMBRANE,
    NOWHERE,
    OBJECT,
    Partner,
    Sums,
    friction_slip,
    meet,
    object_rotation,
    point_place,
)

QUANTUM_N = 2.0**-36
"""Unit in which forces on the object are summed."""


@ti.func
def soft_pass(
    nodes: ti.template(),
    cells: ti.template(),
    surface: ti.template(),
    cases: ti.template(),
    partner: ti.template(),
    count,
    row,
):
    """Contact of the membrane's points with the object, on both."""
    for cell in range(count):
        if cells.cell_cases[cell] == MEMBRANE and cases.choices[MODE] != IDLE:
            for point in range(cells.starts[cell], cells.starts[cell + 1]):
                if surface.held[point] == MEETS_SOFT:
                    at = point_place(nodes, cells, surface, cell, point)
                    place, hit, deformation, distance, gradient = meet(
                        at, row, nodes, cells, cases, partner
                    )
                    if hit != NOWHERE and distance < 0.0:
                        if surface.states[point] == FREE:
                            surface.states[point] = TOUCHED
                            for c in ti.static(range(3)):
                                surface.anchors[3 * point + c] = place[c]
                        anchor = ti.Vector([surface.anchors[3 * point + c] for c in range(3)])
                        steep = deformation.inverse().transpose() @ gradient
                        limit = -friction_now(point, surface, cases, MEMBRANE) * distance
                        limit *= steep.norm()
                        slip = friction_slip(place, anchor, deformation, gradient, limit)
                        push = -surface.points[POINT * point + STIFFNESS] * (
                            distance * steep + deformation @ slip
                        )
                        _give_object(push, place, hit, cells, partner)
                        force = object_rotation(partner) @ push
                        _give_membrane(force, cell, point, cells, surface)
                        for c in ti.static(range(3)):
                            surface.point_forces[3 * point + c] = force[c]
                    elif surface.states[point] == TOUCHED:
                        surface.states[point] = FREE


@ti.func
def _give_object(push, place, cell, cells: ti.template(), partner: ti.template()):
    """Take a force from the object's nodes, in whole quanta."""
    index = place * partner.lattice[12]
    local = index - ti.floor(index + 0.5)
    x, y, z = line_weights(local[0]), line_weights(local[1]), line_weights(local[2])
    for n in ti.static(range(27)):
        weight = x[n // 9] * y[n // 3 % 3] * z[n % 3]
        base = 3 * (cells.rows[entry(cell, n // 3, 9)] + n % 3)
        for c in ti.static(range(3)):
            quanta = ti.cast(-weight * push[c], ti.f64) / QUANTUM_N
            ti.atomic_add(partner.object_forces[base + c], ti.cast(ti.round(quanta), ti.i64))


@ti.func
def _give_membrane(force, cell, point, cells: ti.template(), surface: ti.template()):
    """Add a force to the slots of the point's cell, which no other thread writes."""
    x, y, z = (
        line_weights(surface.points[POINT * point + LOCAL]),
        line_weights(surface.points[POINT * point + LOCAL + 1]),
        line_weights(surface.points[POINT * point + LOCAL + 2]),
    )
    base = entry(cell, 0, 81)
    for n in ti.static(range(27)):
        weight = x[n // 9] * y[n // 3 % 3] * z[n % 3]
        for c in ti.static(range(3)):
            cells.slots[base + (3 * n + c) * BLOCK] += weight * force[c]


@ti.func
def deposit_pass(
    nodes: ti.template(), cells: ti.template(), partner: ti.template(), nothing, count
):
    """Put what the object's nodes gathered into one of the slots that belong to each."""
    for node in range(count):
        if nodes.node_cases[node] == OBJECT:
            slot = nothing
            for place in range(27):
                if slot == nothing:
                    slot = nodes.node_slots[entry(node, place, 27)]
            for c in ti.static(range(3)):
                gathered = partner.object_forces[3 * node + c]
                if gathered != 0 and slot != nothing:
                    cells.slots[slot + c * BLOCK] += ti.cast(gathered * QUANTUM_N, ti.f32)
                partner.object_forces[3 * node + c] = 0


def _make_substep(linear):
    """The kernel of one substep for a material law; each law is compiled when first used."""

    @ti.kernel
    def soft_substep(
        displacement: Floats, velocity: Floats, forces: Floats, masses: Floats, fixed: Integers,
        powers: Floats, node_slots: Integers, node_cases: Integers,
        rows: Integers, volumes: Floats, moduli: Floats, cell_cases: Integers, slots: Floats,
        starts: Integers,
        points: Floats, held: Integers, goals: Floats, anchors: Floats, states: Integers,
        point_forces: Floats, owners: Integers,
        poses: Floats, numbers: Floats, choices: Integers, coefficients: Floats,
        lattice: Floats, cell_map: Integers, extents: Integers, object_forces: Sums,
        case_count: ti.i32, step: ti.i32,
    ):  # fmt: skip
        nodes = ti.static(
            Nodes(displacement, velocity, forces, masses, fixed, powers, node_slots, node_cases)
        )
        cells = ti.static(Cells(rows, volumes, moduli, cell_cases, slots, starts))
        surface = ti.static(Surface(points, held, goals, anchors, states, point_forces, owners))
        cases = ti.static(Cases(poses, numbers, choices, coefficients))
        partner = ti.static(Partner(lattice, cell_map, extents, object_forces))
        cell_count, node_count = cell_cases.shape[0], node_cases.shape[0]
        point_count = owners.shape[0]
        nothing, row = slots.shape[0] - 81 * BLOCK, step * case_count + MEMBRANE
        surface_pass(nodes, cells, surface, cases, point_count, case_count, step)
        cell_pass(nodes, cells, surface, cases, cell_count, linear)
        soft_pass(nodes, cells, surface, cases, partner, cell_count, row)
        deposit_pass(nodes, cells, partner, nothing, node_count)
        node_pass(nodes, cells, cases, node_count)

    return soft_substep


SOFT_SUBSTEP = {linear: _make_substep(linear) for linear in (False, True)}
"""By whether the law is linear: a substep of a membrane and a soft object."""


@ti.kernel
def commit_soft_anchors(
    nodes: pack_of(Nodes),
    cells: pack_of(Cells),
    surface: pack_of(Surface),
    cases: pack_of(Cases),
    partner: pack_of(Partner),
    slips: Floats,
    slid_mm: ti.f32,
):
    """Close a settled frame: anchors follow the points that slid (`kernels.commit_anchors`)."""
    for cell in range(cells.cell_cases.shape[0]):
        if cells.cell_cases[cell] == MEMBRANE:
            for point in range(cells.starts[cell], cells.starts[cell + 1]):
                if surface.held[point] == MEETS_SOFT:
                    at = point_place(nodes, cells, surface, cell, point)
                    place, hit, deformation, distance, gradient = meet(
                        at, MEMBRANE, nodes, cells, cases, partner
                    )
                    if hit != NOWHERE and distance < 0.0 and surface.states[point] != FREE:
                        anchor = ti.Vector([surface.anchors[3 * point + c] for c in range(3)])
                        steep = deformation.inverse().transpose() @ gradient
                        limit = -friction_now(point, surface, cases, MEMBRANE) * distance
                        limit *= steep.norm()
                        slip = friction_slip(place, anchor, deformation, gradient, limit)
                        normal = gradient / ti.max(gradient.norm(), 1e-9)
                        way = place - slip - anchor
                        length = (deformation @ (way - way.dot(normal) * normal)).norm()
                        slips[point] += length
                        surface.states[point] = HELD
                        if length > slid_mm:
                            surface.states[point] = SLID
                        for c in ti.static(range(3)):
                            surface.anchors[3 * point + c] = place[c] - slip[c]
                    else:
                        surface.states[point] = FREE
