"""Taichi kernels of the contact solver: one code path for CPU and CUDA, one or many presses.

Every array and constant is an argument, so that the compile cache serves all designs. No thread
adds into memory that another one writes, and no sum depends on the thread count or on the other
presses of a batch: results are the same bit by bit on each run of one device.

One substep is three passes. Pass 1 (a thread per cell) reads 27 nodal displacements, forms the
stress at the cell's 8 points and writes 27 nodal forces into the cell's own 81 slots. Pass 2 (a
thread per cell that owns surface points) adds contact and holding forces into the same slots.
Pass 3 (a thread per node) sums the 27 slots that belong to the node and moves it.

Cells, nodes and surface points of all presses (cases) follow each other; `numbers` and `choices`
hold what differs between cases, `poses` where each object is in each substep of a batch.
The plain twin of each kernel is in `reference`. Layouts are described in `domain` and `batch`.
"""

# Taichi reads annotations and operators in its own way.
# pyright: reportInvalidTypeForm=false, reportGeneralTypeIssues=false, reportIndexIssue=false

import taichi as ti

from sim.contact.cell_kernel import entry, stress_pass
from sim.contact.domain import BLOCK, NO_SLOT
from sim.contact.layout import (
    CHOICES,
    COUNTS,
    DAMPING,
    FIRST_COEFFICIENT,
    FREE,
    FRICTION,
    HELD,
    IDLE,
    LARGEST_STEP,
    MASS_SCALE,
    MODE,
    MOVING,
    NUMBERS,
    POSE,
    SHAPE,
    SIZE,
    TOUCHED,
)
from sim.contact.signed_distance import signed_distance

Floats = ti.types.ndarray(dtype=ti.f32, ndim=1)
Integers = ti.types.ndarray(dtype=ti.i32, ndim=1)


@ti.func
def _body_rotation(poses: ti.template(), row):
    """Rotation body to sensor of a row of the pose table."""
    base = POSE * row + 3
    return ti.Matrix([[poses[base + 3 * r + c] for c in range(3)] for r in range(3)])


@ti.func
def _object_distance(
    place, numbers: ti.template(), choices: ti.template(), coefficients: ti.template(), case
):
    """Signed distance of a case's object and its gradient, in the body frame."""
    size = ti.Vector([numbers[NUMBERS * case + SIZE + c] for c in range(8)])
    counts = ti.Vector([choices[CHOICES * case + COUNTS + c] for c in range(3)])
    shape = choices[CHOICES * case + SHAPE]
    first = choices[CHOICES * case + FIRST_COEFFICIENT]
    return signed_distance(place, shape, size, coefficients, counts, first)


@ti.func
def _point_displacement(
    displacement: ti.template(), rows: ti.template(), weights: ti.template(), cell, point
):
    moved = ti.Vector([0.0, 0.0, 0.0])
    for node in ti.static(range(27)):
        weight = weights[27 * point + node]
        base = 3 * (rows[entry(cell, node // 3, 9)] + node % 3)
        for c in ti.static(range(3)):
            moved[c] += weight * displacement[base + c]
    return moved


@ti.func
def _tangent_slip(place, gradient, anchor, limit):
    """Slip from the anchor in the tangent plane, returned to the friction cone."""
    normal = gradient / ti.max(gradient.norm(), 1e-9)
    slip = place - anchor
    slip -= slip.dot(normal) * normal
    length = slip.norm()
    if length > limit:
        slip *= limit / length
    return slip


@ti.func
def _place_in_body(
    point, moved, positions: ti.template(), poses: ti.template(), rotation: ti.template(), row
):
    place = moved
    for c in ti.static(range(3)):
        place[c] += positions[3 * point + c] - poses[POSE * row + c]
    return rotation.transpose() @ place


@ti.func
def _holding_force(
    point,
    moved,
    stiffness: ti.template(),
    axes: ti.template(),
    sideways: ti.template(),
    goals: ti.template(),
    share,
):
    """Spring of a held point toward where it belongs, stiffer along its axis than across."""
    axis = ti.Vector([axes[3 * point + c] for c in range(3)])
    away = moved
    for c in ti.static(range(3)):
        start, end = goals[6 * point + c], goals[6 * point + 3 + c]
        away[c] -= start + share * (end - start)
    along = axis.dot(away) * axis
    return -stiffness[point] * (along + sideways[point] * (away - along))


@ti.func
def _contact_force(
    point,
    moved,
    positions: ti.template(),
    stiffness: ti.template(),
    anchors: ti.template(),
    states: ti.template(),
    poses: ti.template(),
    numbers: ti.template(),
    choices: ti.template(),
    coefficients: ti.template(),
    case,
    row,
):
    """Penalty and friction of the object on the membrane, in the sensor frame [N]."""
    force = ti.Vector([0.0, 0.0, 0.0])
    rotation = _body_rotation(poses, row)
    place = _place_in_body(point, moved, positions, poses, rotation, row)
    distance, gradient = _object_distance(place, numbers, choices, coefficients, case)
    if distance < 0.0:
        anchor = place
        if states[point] == FREE:
            states[point] = TOUCHED
            for c in ti.static(range(3)):
                anchors[3 * point + c] = place[c]
        for c in ti.static(range(3)):
            anchor[c] = anchors[3 * point + c]
        limit = -numbers[NUMBERS * case + FRICTION] * distance * gradient.norm()
        slip = _tangent_slip(place, gradient, anchor, limit)
        force = -stiffness[point] * (rotation @ (distance * gradient + slip))
    elif states[point] == TOUCHED:
        states[point] = FREE
    return force


@ti.func
def surface_pass(
    displacement: ti.template(),
    rows: ti.template(),
    cell_cases: ti.template(),
    slots: ti.template(),
    owners: ti.template(),
    starts: ti.template(),
    weights: ti.template(),
    positions: ti.template(),
    stiffness: ti.template(),
    axes: ti.template(),
    sideways: ti.template(),
    held: ti.template(),
    goals: ti.template(),
    anchors: ti.template(),
    states: ti.template(),
    point_forces: ti.template(),
    poses: ti.template(),
    numbers: ti.template(),
    choices: ti.template(),
    coefficients: ti.template(),
    cases,
    step,
):
    for owner in range(owners.shape[0]):
        cell = owners[owner]
        case = cell_cases[cell]
        if choices[CHOICES * case + MODE] != IDLE:
            row = step * cases + case
            base = entry(cell, 0, 81)
            for point in range(starts[owner], starts[owner + 1]):
                moved = _point_displacement(displacement, rows, weights, cell, point)
                force = ti.Vector([0.0, 0.0, 0.0])
                if held[point] == 1:
                    share = poses[POSE * row + POSE - 1]
                    force = _holding_force(point, moved, stiffness, axes, sideways, goals, share)
                else:
                    force = _contact_force(
                        point, moved, positions, stiffness, anchors, states, poses, numbers,
                        choices, coefficients, case, row,
                    )  # fmt: skip
                for c in ti.static(range(3)):
                    point_forces[3 * point + c] = force[c]
                if force.norm_sqr() > 0.0:
                    for node in ti.static(range(27)):
                        weight = weights[27 * point + node]
                        for c in ti.static(range(3)):
                            slots[base + (3 * node + c) * BLOCK] += weight * force[c]


@ti.func
def node_pass(
    displacement: ti.template(),
    velocity: ti.template(),
    forces: ti.template(),
    slots: ti.template(),
    node_slots: ti.template(),
    node_cases: ti.template(),
    masses: ti.template(),
    fixed: ti.template(),
    powers: ti.template(),
    numbers: ti.template(),
    choices: ti.template(),
):
    for node in range(node_cases.shape[0]):
        case = node_cases[node]
        mode = choices[CHOICES * case + MODE]
        if mode != IDLE:
            total = ti.Vector([0.0, 0.0, 0.0])
            for place in ti.static(range(27)):
                slot = node_slots[entry(node, place, 27)]
                if slot != NO_SLOT:
                    for c in ti.static(range(3)):
                        total[c] += slots[slot + c * BLOCK]
            mass = masses[node] * numbers[NUMBERS * case + MASS_SCALE]
            damping = numbers[NUMBERS * case + DAMPING]
            largest_step = numbers[NUMBERS * case + LARGEST_STEP]
            work, inertia = 0.0, 0.0
            for c in ti.static(range(3)):
                at = 3 * node + c
                speed = velocity[at]
                work += speed * (forces[at] - total[c])
                inertia += mass * speed * speed
                forces[at] = total[c]
                if fixed[node] == 0 and mode == MOVING:
                    speed = ((2.0 - damping) * speed + 2.0 * total[c] / mass) / (2.0 + damping)
                    speed = ti.min(ti.max(speed, -largest_step), largest_step)
                    velocity[at] = speed
                    displacement[at] += speed
            powers[2 * node] = work
            powers[2 * node + 1] = inertia


def _make_substep(linear):
    """The kernel of one substep for a material law; each law is compiled when first used."""

    @ti.kernel
    def substep(
        displacement: Floats,
        velocity: Floats,
        forces: Floats,
        slots: Floats,
        rows: Integers,
        volumes: Floats,
        moduli: Floats,
        cell_cases: Integers,
        node_slots: Integers,
        node_cases: Integers,
        masses: Floats,
        fixed: Integers,
        powers: Floats,
        owners: Integers,
        starts: Integers,
        weights: Floats,
        positions: Floats,
        stiffness: Floats,
        axes: Floats,
        sideways: Floats,
        held: Integers,
        goals: Floats,
        anchors: Floats,
        states: Integers,
        point_forces: Floats,
        poses: Floats,
        numbers: Floats,
        choices: Integers,
        coefficients: Floats,
        cases: ti.i32,
        step: ti.i32,
    ):
        stress_pass(
            displacement, rows, volumes, moduli, cell_cases, slots, numbers, choices, linear
        )
        surface_pass(
            displacement, rows, cell_cases, slots, owners, starts, weights, positions, stiffness,
            axes, sideways, held, goals, anchors, states, point_forces, poses, numbers, choices,
            coefficients, cases, step,
        )  # fmt: skip
        node_pass(
            displacement, velocity, forces, slots, node_slots, node_cases, masses,
            fixed, powers, numbers, choices,
        )  # fmt: skip

    return substep


SUBSTEP = {linear: _make_substep(linear) for linear in (False, True)}
"""By whether the law is linear: forces at the present displacement, then one damped step of the
nodes of each moving case."""


SUBSTEP_ARRAYS = (
    "displacement",
    "velocity",
    "forces",
    "slots",
    "rows",
    "volumes",
    "moduli",
    "cell_cases",
    "node_slots",
    "node_cases",
    "masses",
    "fixed",
    "powers",
    "owners",
    "starts",
    "weights",
    "positions",
    "stiffness",
    "axes",
    "sideways",
    "held",
    "goals",
    "anchors",
    "states",
    "point_forces",
    "poses",
    "numbers",
    "choices",
    "coefficients",
)
"""Names of the arrays of a substep, in its order."""
INTEGER_ARRAYS = frozenset(
    (
        "rows",
        "cell_cases",
        "node_slots",
        "node_cases",
        "fixed",
        "owners",
        "starts",
        "held",
        "states",
        "choices",
    )
)


@ti.kernel
def commit_anchors(
    displacement: Floats,
    rows: Integers,
    cell_cases: Integers,
    owners: Integers,
    starts: Integers,
    weights: Floats,
    positions: Floats,
    held: Integers,
    anchors: Floats,
    states: Integers,
    slips: Floats,
    poses: Floats,
    numbers: Floats,
    choices: Integers,
    coefficients: Floats,
    committing: ti.i32,
):
    """Close a settled frame of a case, by its pose in the first step of the table.

    Anchors follow the points that slid, and the way they go is added to `slips`; contacts become
    history.
    """
    for owner in range(owners.shape[0]):
        cell = owners[owner]
        case = cell_cases[cell]
        if case == committing:
            rotation = _body_rotation(poses, case)
            for point in range(starts[owner], starts[owner + 1]):
                if held[point] == 0:
                    place = _point_displacement(displacement, rows, weights, cell, point)
                    place = _place_in_body(point, place, positions, poses, rotation, case)
                    distance, gradient = _object_distance(
                        place, numbers, choices, coefficients, case
                    )
                    if distance < 0.0 and states[point] != FREE:
                        anchor = place
                        for c in ti.static(range(3)):
                            anchor[c] = anchors[3 * point + c]
                        limit = -numbers[NUMBERS * case + FRICTION] * distance * gradient.norm()
                        new = place - _tangent_slip(place, gradient, anchor, limit)
                        way = new - anchor
                        normal = gradient / ti.max(gradient.norm(), 1e-9)
                        slips[point] += (way - way.dot(normal) * normal).norm()
                        states[point] = HELD
                        for c in ti.static(range(3)):
                            anchors[3 * point + c] = new[c]
                    else:
                        states[point] = FREE
