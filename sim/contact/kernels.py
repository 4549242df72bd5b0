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
from taichi.lang.impl import expr_init

from sim.contact.domain import SLOT_BLOCK as BLOCK
from sim.contact.signed_distance import signed_distance
from sim.contact.stencil import gather_gradient, scatter_gradient
from sim.material import SMALLEST_VOLUME_RATIO, first_piola_rows

CHUNK = 128
"""Rows summed by one thread of a reduction; fixed, so that the order of sums is too."""
FREE, TOUCHED, HELD = 0, 1, 2
"""States of a contact point: apart; anchored within this frame; anchored by a settled frame."""
IDLE, MOVING, STILL = 0, 1, 2
"""Modes of a case: left alone; relaxing; forces only."""
FRICTION, MASS_SCALE, DAMPING, LARGEST_STEP, INVERSE_EDGE, SIZE = 0, 1, 2, 3, 4, 5
NUMBERS = 13
"""Floats of a case: the above, with the eight of the object's size at the end."""
MODE, SHAPE, FIRST_COEFFICIENT, COUNTS = 0, 1, 2, 3
CHOICES = 6
"""Integers of a case: the above, with the three counts of distance samples at the end."""
POSE = 13
"""Floats of a pose: origin from the target, rotation by rows, share of the drives' way."""

Floats = ti.types.ndarray(dtype=ti.f32, ndim=1)
Integers = ti.types.ndarray(dtype=ti.i32, ndim=1)
Doubles = ti.types.ndarray(dtype=ti.f64, ndim=1)


def _inverse_cube_root(ratio):
    """J^(-1/3) by Newton's iteration: `exp` and `log` would take a third of the substep."""
    guarded = expr_init(ti.max(ratio, SMALLEST_VOLUME_RATIO))
    root = expr_init(ti.select(guarded < 0.6, 1.6 - guarded, 4.0 / (3.0 + guarded)))
    for _ in range(4):
        root = expr_init(root * (4.0 - guarded * root * root * root) * (1.0 / 3.0))
    return root


def _cell_forces(nodal, volumes, inverse_edge, moduli, linear):
    """Forces [N] on 27 nodes of a cell: -sum over points of volume P grad(weight)."""
    gradients = [gather_gradient(component, expr_init) for component in nodal]
    flux = [[[] for _ in range(8)] for _ in range(3)]
    for p in range(8):
        rows = [[expr_init(gradients[r][p][c] * inverse_edge) for c in range(3)] for r in range(3)]
        stress = first_piola_rows(rows, moduli, _inverse_cube_root, keep=expr_init, linear=linear)
        scale = expr_init(-volumes[p] * inverse_edge)
        for r in range(3):
            flux[r][p] = [expr_init(scale * stress[r][c]) for c in range(3)]
    return [scatter_gradient(component, expr_init) for component in flux]


@ti.func
def slot_base(cell):
    """Index of the first slot of a cell; slot v follows at v * BLOCK."""
    return (cell // BLOCK) * (81 * BLOCK) + cell % BLOCK


@ti.func
def stress_pass(
    displacement: ti.template(),
    rows: ti.template(),
    volumes: ti.template(),
    moduli: ti.template(),
    cell_cases: ti.template(),
    slots: ti.template(),
    numbers: ti.template(),
    choices: ti.template(),
    linear: ti.template(),
):
    for cell in range(cell_cases.shape[0]):
        case = cell_cases[cell]
        if choices[CHOICES * case + MODE] != IDLE:
            first = [rows[9 * cell + r] for r in range(9)]
            volume = [volumes[8 * cell + p] for p in range(8)]
            nodal = [
                [displacement[3 * (first[n // 3] + n % 3) + c] for n in range(27)] for c in range(3)
            ]
            inverse_edge = numbers[NUMBERS * case + INVERSE_EDGE]
            shear, bulk = moduli[2 * cell], moduli[2 * cell + 1]
            forces = ti.static(_cell_forces(nodal, volume, inverse_edge, (shear, bulk), linear))
            base = slot_base(cell)
            for n in ti.static(range(27)):
                for c in ti.static(range(3)):
                    slots[base + (3 * n + c) * BLOCK] = forces[c][n]


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
        base = 3 * (rows[9 * cell + node // 3] + node % 3)
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
            base = slot_base(cell)
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
    node_starts: ti.template(),
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
            for entry in range(node_starts[node], node_starts[node + 1]):
                slot = node_slots[entry]
                for c in ti.static(range(3)):
                    total[c] += slots[slot + c * BLOCK]
            mass = masses[node] * numbers[NUMBERS * case + MASS_SCALE]
            damping = numbers[NUMBERS * case + DAMPING]
            largest_step = numbers[NUMBERS * case + LARGEST_STEP]
            work, inertia = 0.0, 0.0
            for c in ti.static(range(3)):
                entry = 3 * node + c
                speed = velocity[entry]
                work += speed * (forces[entry] - total[c])
                inertia += mass * speed * speed
                forces[entry] = total[c]
                if fixed[node] == 0 and mode == MOVING:
                    speed = ((2.0 - damping) * speed + 2.0 * total[c] / mass) / (2.0 + damping)
                    speed = ti.min(ti.max(speed, -largest_step), largest_step)
                    velocity[entry] = speed
                    displacement[entry] += speed
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
        node_starts: Integers,
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
            displacement, velocity, forces, slots, node_starts, node_slots, node_cases, masses,
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
    "node_starts",
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
        "node_starts",
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
def surface_sums(point_forces: Floats, held: Integers, bounds: Integers, partial: Doubles):
    """Per chunk of surface points: contact force, then holding force, by component."""
    for chunk in range(bounds.shape[0] // 2):
        total = ti.Vector([0.0] * 6, dt=ti.f64)
        for point in range(bounds[2 * chunk], bounds[2 * chunk + 1]):
            for c in ti.static(range(3)):
                if held[point] == 0:
                    total[c] += point_forces[3 * point + c]
                else:
                    total[3 + c] += point_forces[3 * point + c]
        for c in ti.static(range(6)):
            partial[6 * chunk + c] = total[c]


@ti.kernel
def case_sums(partial: Doubles, first_chunks: Integers, totals: Doubles):
    """Sums of a case's chunks, in their order."""
    for case in range(first_chunks.shape[0] - 1):
        total = ti.Vector([0.0] * 6, dt=ti.f64)
        for chunk in range(first_chunks[case], first_chunks[case + 1]):
            for c in ti.static(range(6)):
                total[c] += partial[6 * chunk + c]
        for c in ti.static(range(6)):
            totals[6 * case + c] = total[c]


@ti.kernel
def copy_out(source: Floats, target: Floats, first: ti.i32, count: ti.i32):
    """Copy entries `first` and following of a long array to the start of a short one."""
    for i in range(count):
        target[i] = source[first + i]


@ti.kernel
def copy_in(source: Floats, target: Floats, first: ti.i32, count: ti.i32):
    """Copy the start of a short array to entries `first` and following of a long one."""
    for i in range(count):
        target[first + i] = source[i]


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
