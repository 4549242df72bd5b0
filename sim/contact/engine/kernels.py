"""Taichi kernels of the contact solver: one code path for CPU and CUDA, one or many presses.

Every array and constant is an argument, so that the compile cache serves all designs. No thread
adds into memory that another one writes, and no sum depends on the thread count or on the other
presses of a batch: results are the same bit by bit on each run of one device.

One substep is two passes. Pass 1 (`cell_kernel`, a thread per cell) reads 27 nodal displacements,
forms the stress at the cell's 8 points, adds the contact and holding forces of its surface points,
and writes 27 nodal forces into the cell's own 81 slots. Pass 2 (a thread per node) sums the 27
slots that belong to the node and moves it.

Cells, nodes and surface points of all presses (cases) follow each other; `numbers` and `choices`
hold what differs between cases, `poses` where each object is in each substep of a batch.
The plain twin of each kernel is in `reference`. Layouts are described in `domain` and `batch`.
"""

# Taichi reads annotations and operators in its own way.
# pyright: reportInvalidTypeForm=false, reportGeneralTypeIssues=false, reportIndexIssue=false

import taichi as ti

from sim.contact.engine.cell_kernel import cell_pass, entry
from sim.contact.engine.point_functions import (
    body_rotation,
    line_weights,
    object_distance,
    place_in_body,
    tangent_slip,
)
from sim.contact.grid.layout import (
    CHOICES,
    DAMPING,
    FREE,
    FRICTION,
    HELD,
    IDLE,
    LARGEST_STEP,
    LOCAL,
    MASS_SCALE,
    MEETS_RIGID,
    MODE,
    MOVING,
    NUMBERS,
    POINT,
)
from sim.contact.region.domain import BLOCK

Floats = ti.types.ndarray(dtype=ti.f32, ndim=1)
Integers = ti.types.ndarray(dtype=ti.i32, ndim=1)


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
    nodes,
):
    for node in range(nodes):
        case = node_cases[node]
        mode = choices[CHOICES * case + MODE]
        if mode != IDLE:
            total = ti.Vector([0.0, 0.0, 0.0])
            for place in ti.static(range(27)):
                slot = node_slots[entry(node, place, 27)]
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
        starts: Integers,
        points: Floats,
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
        # All bounds first: Taichi then finds them in one task instead of one before each loop.
        cells, nodes = cell_cases.shape[0], node_cases.shape[0]
        cell_pass(
            displacement, rows, volumes, moduli, cell_cases, slots, starts, points, held, goals,
            anchors, states, point_forces, poses, numbers, choices, coefficients, cells, cases,
            step, linear,
        )  # fmt: skip
        node_pass(
            displacement, velocity, forces, slots, node_slots, node_cases, masses, fixed, powers,
            numbers, choices, nodes,
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
    "starts",
    "points",
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


@ti.func
def point_displacement(
    displacement: ti.template(), rows: ti.template(), points: ti.template(), cell, point
):
    """Displacement [mm] of a surface point from the nodes of its cell."""
    x = line_weights(points[POINT * point + LOCAL])
    y = line_weights(points[POINT * point + LOCAL + 1])
    z = line_weights(points[POINT * point + LOCAL + 2])
    moved = ti.Vector([0.0, 0.0, 0.0])
    for n in ti.static(range(27)):
        weight = x[n // 9] * y[n // 3 % 3] * z[n % 3]
        base = 3 * (rows[entry(cell, n // 3, 9)] + n % 3)
        for c in ti.static(range(3)):
            moved[c] += weight * displacement[base + c]
    return moved


@ti.kernel
def commit_anchors(
    displacement: Floats,
    rows: Integers,
    cell_cases: Integers,
    starts: Integers,
    points: Floats,
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
    for cell in range(cell_cases.shape[0]):
        case = cell_cases[cell]
        if case == committing:
            rotation = body_rotation(poses, case)
            for point in range(starts[cell], starts[cell + 1]):
                if held[point] == MEETS_RIGID:
                    place = point_displacement(displacement, rows, points, cell, point)
                    place = place_in_body(point, place, points, poses, rotation, case)
                    distance, gradient = object_distance(
                        place, numbers, choices, coefficients, case
                    )
                    if distance < 0.0 and states[point] != FREE:
                        anchor = place
                        for c in ti.static(range(3)):
                            anchor[c] = anchors[3 * point + c]
                        limit = -numbers[NUMBERS * case + FRICTION] * distance * gradient.norm()
                        new = place - tangent_slip(place, gradient, anchor, limit)
                        way = new - anchor
                        normal = gradient / ti.max(gradient.norm(), 1e-9)
                        slips[point] += (way - way.dot(normal) * normal).norm()
                        states[point] = HELD
                        for c in ti.static(range(3)):
                            anchors[3 * point + c] = new[c]
                    else:
                        states[point] = FREE
