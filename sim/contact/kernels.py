"""Taichi kernels of the contact solver: one code path for CPU and CUDA.

Every array and constant is an argument, so that the compile cache serves all designs. No thread
adds into memory that another one writes, and no sum depends on the thread count: results are the
same bit by bit on each run of one device.

One substep is three passes. Pass 1 (a thread per cell) reads 27 nodal displacements, forms the
stress at the cell's 8 points and writes 27 nodal forces into the cell's own 81 slots. Pass 2 (a
thread per cell that owns surface points) adds contact and bonding forces into the same slots.
Pass 3 (a thread per node) sums the 27 slots that belong to the node and moves it.

The plain twin of each kernel is in `reference`. Layouts are described in `domain`.
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


def _cell_forces(nodal, volumes, inverse_edge, moduli):
    """Forces [N] on 27 nodes of a cell: -sum over points of volume P grad(weight)."""
    gradients = [gather_gradient(component, expr_init) for component in nodal]
    flux = [[[] for _ in range(8)] for _ in range(3)]
    for p in range(8):
        rows = [[expr_init(gradients[r][p][c] * inverse_edge) for c in range(3)] for r in range(3)]
        stress = first_piola_rows(rows, moduli, _inverse_cube_root, keep=expr_init)
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
    slots: ti.template(),
    inverse_edge,
    shear,
    bulk,
):
    for cell in range(rows.shape[0] // 9):
        first = [rows[9 * cell + r] for r in range(9)]
        volume = [volumes[8 * cell + p] for p in range(8)]
        nodal = [
            [displacement[3 * (first[n // 3] + n % 3) + c] for n in range(27)] for c in range(3)
        ]
        forces = ti.static(_cell_forces(nodal, volume, inverse_edge, (shear, bulk)))
        base = slot_base(cell)
        for n in ti.static(range(27)):
            for c in ti.static(range(3)):
                slots[base + (3 * n + c) * BLOCK] = forces[c][n]


@ti.func
def _body_rotation(poses: ti.template(), step):
    """Rotation body to sensor of row `step` of the pose table."""
    base = 12 * step + 3
    return ti.Matrix([[poses[base + 3 * r + c] for c in range(3)] for r in range(3)])


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
def _surface_force(
    point,
    moved,
    positions: ti.template(),
    stiffness: ti.template(),
    axes: ti.template(),
    sideways: ti.template(),
    bonded: ti.template(),
    anchors: ti.template(),
    states: ti.template(),
    poses: ti.template(),
    step,
    shape,
    size: ti.template(),
    coefficients: ti.template(),
    counts: ti.template(),
    friction,
):
    """Force [N] on the membrane at a surface point, in the sensor frame."""
    axis = ti.Vector([axes[3 * point + c] for c in range(3)])
    along = axis.dot(moved) * axis
    force = -stiffness[point] * (along + sideways[point] * (moved - along))
    if bonded[point] == 0:
        force = ti.Vector([0.0, 0.0, 0.0])
        place = moved
        for c in ti.static(range(3)):
            place[c] += positions[3 * point + c] - poses[12 * step + c]
        rotation = _body_rotation(poses, step)
        place = rotation.transpose() @ place
        distance, gradient = signed_distance(place, shape, size, coefficients, counts)
        if distance < 0.0:
            anchor = place
            if states[point] == FREE:
                states[point] = TOUCHED
                for c in ti.static(range(3)):
                    anchors[3 * point + c] = place[c]
            for c in ti.static(range(3)):
                anchor[c] = anchors[3 * point + c]
            limit = -friction * distance * gradient.norm()
            slip = _tangent_slip(place, gradient, anchor, limit)
            force = -stiffness[point] * (rotation @ (distance * gradient + slip))
        elif states[point] == TOUCHED:
            states[point] = FREE
    return force


@ti.func
def surface_pass(
    displacement: ti.template(),
    rows: ti.template(),
    slots: ti.template(),
    owners: ti.template(),
    starts: ti.template(),
    weights: ti.template(),
    positions: ti.template(),
    stiffness: ti.template(),
    axes: ti.template(),
    sideways: ti.template(),
    bonded: ti.template(),
    anchors: ti.template(),
    states: ti.template(),
    point_forces: ti.template(),
    poses: ti.template(),
    step,
    shape,
    size: ti.template(),
    coefficients: ti.template(),
    counts: ti.template(),
    friction,
):
    for owner in range(owners.shape[0]):
        cell = owners[owner]
        base = slot_base(cell)
        for point in range(starts[owner], starts[owner + 1]):
            moved = _point_displacement(displacement, rows, weights, cell, point)
            force = _surface_force(
                point, moved, positions, stiffness, axes, sideways, bonded, anchors, states,
                poses, step, shape, size, coefficients, counts, friction,
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
    masses: ti.template(),
    fixed: ti.template(),
    powers: ti.template(),
    mass_scale,
    damping,
    largest_step,
    moving,
):
    for node in range(masses.shape[0]):
        total = ti.Vector([0.0, 0.0, 0.0])
        for entry in range(node_starts[node], node_starts[node + 1]):
            slot = node_slots[entry]
            for c in ti.static(range(3)):
                total[c] += slots[slot + c * BLOCK]
        mass = masses[node] * mass_scale
        work, inertia = 0.0, 0.0
        for c in ti.static(range(3)):
            entry = 3 * node + c
            speed = velocity[entry]
            work += speed * (forces[entry] - total[c])
            inertia += mass * speed * speed
            forces[entry] = total[c]
            if fixed[node] == 0 and moving == 1:
                speed = ((2.0 - damping) * speed + 2.0 * total[c] / mass) / (2.0 + damping)
                speed = ti.min(ti.max(speed, -largest_step), largest_step)
                velocity[entry] = speed
                displacement[entry] += speed
        powers[2 * node] = work
        powers[2 * node + 1] = inertia


@ti.kernel
def substep(
    displacement: Floats,
    velocity: Floats,
    forces: Floats,
    slots: Floats,
    rows: Integers,
    volumes: Floats,
    node_starts: Integers,
    node_slots: Integers,
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
    bonded: Integers,
    anchors: Floats,
    states: Integers,
    point_forces: Floats,
    poses: Floats,
    size: Floats,
    coefficients: Floats,
    counts: Integers,
    step: ti.i32,
    shape: ti.i32,
    moving: ti.i32,
    inverse_edge: ti.f32,
    shear: ti.f32,
    bulk: ti.f32,
    friction: ti.f32,
    mass_scale: ti.f32,
    damping: ti.f32,
    largest_step: ti.f32,
):
    """Forces at the present displacement, then one damped step of the nodes if `moving`."""
    stress_pass(displacement, rows, volumes, slots, inverse_edge, shear, bulk)
    surface_pass(
        displacement, rows, slots, owners, starts, weights, positions, stiffness, axes, sideways,
        bonded, anchors, states, point_forces, poses, step, shape, size, coefficients,
        counts, friction,
    )  # fmt: skip
    node_pass(
        displacement, velocity, forces, slots, node_starts, node_slots, masses, fixed, powers,
        mass_scale, damping, largest_step, moving,
    )  # fmt: skip


@ti.kernel
def commit_anchors(
    displacement: Floats,
    rows: Integers,
    owners: Integers,
    starts: Integers,
    weights: Floats,
    positions: Floats,
    bonded: Integers,
    anchors: Floats,
    states: Integers,
    poses: Floats,
    size: Floats,
    coefficients: Floats,
    counts: Integers,
    step: ti.i32,
    shape: ti.i32,
    friction: ti.f32,
):
    """Close a settled frame: anchors follow the points that slid, contacts become history."""
    for owner in range(owners.shape[0]):
        cell = owners[owner]
        for point in range(starts[owner], starts[owner + 1]):
            if bonded[point] == 0:
                place = _point_displacement(displacement, rows, weights, cell, point)
                for c in ti.static(range(3)):
                    place[c] += positions[3 * point + c] - poses[12 * step + c]
                place = _body_rotation(poses, step).transpose() @ place
                distance, gradient = signed_distance(place, shape, size, coefficients, counts)
                if distance < 0.0 and states[point] != FREE:
                    anchor = place
                    for c in ti.static(range(3)):
                        anchor[c] = anchors[3 * point + c]
                    limit = -friction * distance * gradient.norm()
                    slip = _tangent_slip(place, gradient, anchor, limit)
                    states[point] = HELD
                    for c in ti.static(range(3)):
                        anchors[3 * point + c] = place[c] - slip[c]
                else:
                    states[point] = FREE


@ti.kernel
def node_sums(forces: Floats, powers: Floats, fixed: Integers, partial: Doubles):
    """Per chunk of nodes: work, inertia, squared free force, and the free force by component."""
    for chunk in range(partial.shape[0] // 6):
        total = ti.Vector([0.0] * 6, dt=ti.f64)
        last = ti.min((chunk + 1) * CHUNK, fixed.shape[0])
        for node in range(chunk * CHUNK, last):
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
def surface_sums(point_forces: Floats, bonded: Integers, partial: Doubles):
    """Per chunk of surface points: contact force, then bonding force, by component."""
    for chunk in range(partial.shape[0] // 6):
        total = ti.Vector([0.0] * 6, dt=ti.f64)
        last = ti.min((chunk + 1) * CHUNK, bonded.shape[0])
        for point in range(chunk * CHUNK, last):
            for c in ti.static(range(3)):
                if bonded[point] == 0:
                    total[c] += point_forces[3 * point + c]
                else:
                    total[3 + c] += point_forces[3 * point + c]
        for c in ti.static(range(6)):
            partial[6 * chunk + c] = total[c]
