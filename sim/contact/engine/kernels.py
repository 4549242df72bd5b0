"""Taichi kernels of the contact solver: one code path for CPU and CUDA, one or many presses.

Every array and constant is an argument, so that the compile cache serves all designs. No thread
adds into memory that another one writes, and no sum depends on the thread count or on the other
presses of a batch: results are the same bit by bit on each run of one device.

One substep is three passes. Pass 1 (`surface_kernel`, a thread per surface point) finds contact and
holding forces. Pass 2 (`cell_kernel`, a thread per cell) reads 27 nodal displacements, forms the
stress at the cell's 8 points, adds the forces of its surface points, and writes 27 nodal forces
into the cell's own 81 slots. Pass 3 (a thread per node) sums the 27 slots that belong to the node
and moves it.

Cells, nodes and surface points of all presses (cases) follow each other; `bundles` says what is
known of each. The plain twin of each kernel is in `reference`. Layouts are described in `domain`
and `batch`.
"""

# Taichi reads annotations and operators in its own way.
# pyright: reportInvalidTypeForm=false, reportGeneralTypeIssues=false, reportIndexIssue=false

import functools

import taichi as ti

from sim.contact.engine.blocks import NODE_THREADS, block_size
from sim.contact.engine.bundles import Cases, Cells, Floats, Integers, Nodes, Surface, Ties, pack_of
from sim.contact.engine.cell_kernel import cell_pass, entry
from sim.contact.engine.point_functions import (
    body_rotation,
    friction_now,
    object_distance,
    place_in_body,
    tangent_slip,
)
from sim.contact.engine.surface_kernel import point_displacement, surface_pass
from sim.contact.grid.layout import (
    CHOICES,
    DAMPING,
    FREE,
    HELD,
    IDLE,
    LARGEST_STEP,
    MASS_SCALE,
    MEETS_RIGID,
    MODE,
    MOVING,
    NUMBERS,
    SLID,
    TIED,
    UNHELD,
)
from sim.contact.region.domain import BLOCK


@ti.func
def _slot_sum(node, nodes: ti.template(), cells: ti.template()):
    """Force [N] of the cells around a node."""
    total = ti.Vector([0.0, 0.0, 0.0])
    for place in ti.static(range(27)):
        slot = nodes.node_slots[entry(node, place, 27)]
        for c in ti.static(range(3)):
            total[c] += cells.slots[slot + c * BLOCK]
    return total


@ti.func
def _move_node(node, total, nodes: ti.template(), cases: ti.template(), case, mode):
    """One damped step of a node under its force [N].

    All is read before anything is written: Taichi cannot know that no array lies in another, so a
    read that follows a write waits for it, and on a GPU this pass is made of waiting for memory.
    """
    place = [nodes.displacement[3 * node + c] for c in range(3)]
    speed = [nodes.velocity[3 * node + c] for c in range(3)]
    before = [nodes.forces[3 * node + c] for c in range(3)]
    mass = nodes.masses[node] * cases.numbers[NUMBERS * case + MASS_SCALE]
    damping = cases.numbers[NUMBERS * case + DAMPING]
    largest_step = cases.numbers[NUMBERS * case + LARGEST_STEP]
    moves = nodes.fixed[node] == UNHELD and mode == MOVING
    work, inertia = 0.0, 0.0
    for c in ti.static(range(3)):
        work += speed[c] * (before[c] - total[c])
        inertia += mass * speed[c] * speed[c]
    nodes.powers[2 * node] = work
    nodes.powers[2 * node + 1] = inertia
    for c in ti.static(range(3)):
        nodes.forces[3 * node + c] = total[c]
        if moves:
            found = ((2.0 - damping) * speed[c] + 2.0 * total[c] / mass) / (2.0 + damping)
            found = ti.min(ti.max(found, -largest_step), largest_step)
            nodes.velocity[3 * node + c] = found
            nodes.displacement[3 * node + c] = place[c] + found


@ti.func
def node_pass(nodes: ti.template(), cells: ti.template(), cases: ti.template(), count):
    ti.loop_config(block_dim=ti.static(block_size(NODE_THREADS)))
    for node in range(count):
        case = nodes.node_cases[node]
        mode = cases.choices[CHOICES * case + MODE]
        if mode != IDLE:
            _move_node(node, _slot_sum(node, nodes, cells), nodes, cases, case, mode)


@ti.func
def free_node_pass(
    nodes: ti.template(), cells: ti.template(), cases: ti.template(), ties: ti.template(), count
):
    """Pass 3 where nodes are tied: these and their leaders are left out.

    It is `node_pass` but for one condition, so that a compiler sums the cells of a node in the
    same order in both: a press without ties has the same bits beside one that has some.
    """
    ti.loop_config(block_dim=ti.static(block_size(NODE_THREADS)))
    for node in range(count):
        case = nodes.node_cases[node]
        mode = cases.choices[CHOICES * case + MODE]
        if mode != IDLE and ties.apart[node] == 0:
            _move_node(node, _slot_sum(node, nodes, cells), nodes, cases, case, mode)


@ti.func
def leader_pass(
    nodes: ti.template(), cells: ti.template(), cases: ti.template(), ties: ti.template(), count
):
    """The same of nodes that others follow: they take on these nodes' forces."""
    for number in range(count):
        node = ties.leading[number]
        case = nodes.node_cases[node]
        mode = cases.choices[CHOICES * case + MODE]
        if mode != IDLE and nodes.fixed[node] != TIED:
            total = _slot_sum(node, nodes, cells)
            for pair in range(ties.follower_starts[number], ties.follower_starts[number + 1]):
                for c in ti.static(range(3)):
                    follower = nodes.forces[3 * ties.followers[pair] + c]
                    total[c] += ties.follower_shares[pair] * follower
            _move_node(node, total, nodes, cases, case, mode)


@ti.func
def tied_forces_pass(
    nodes: ti.template(), cells: ti.template(), cases: ti.template(), ties: ti.template(), count
):
    """Forces that tied nodes hand on."""
    for number in range(count):
        node = ties.tied[number]
        if cases.choices[CHOICES * nodes.node_cases[node] + MODE] != IDLE:
            total = _slot_sum(node, nodes, cells)
            for c in ti.static(range(3)):
                nodes.forces[3 * node + c] = total[c]


@ti.func
def tied_moves_pass(nodes: ti.template(), cases: ti.template(), ties: ti.template(), count):
    """Where tied nodes follow to."""
    for number in range(count):
        node = ties.tied[number]
        if cases.choices[CHOICES * nodes.node_cases[node] + MODE] == MOVING:
            moved = ti.Vector([0.0, 0.0, 0.0])
            for pair in range(ties.leader_starts[number], ties.leader_starts[number + 1]):
                for c in ti.static(range(3)):
                    leader = nodes.displacement[3 * ties.leaders[pair] + c]
                    moved[c] += ties.leader_shares[pair] * leader
            for c in ti.static(range(3)):
                nodes.displacement[3 * node + c] = moved[c]


@functools.cache
def substep_of(linear):
    """The kernel of one substep of a material law, compiled when first used.

    Forces at the present displacement, then one damped step of the nodes of each moving case. A
    compute graph binds the arrays by their names.
    """

    @ti.kernel
    def substep(
        displacement: Floats, velocity: Floats, forces: Floats, masses: Floats, fixed: Integers,
        powers: Floats, node_slots: Integers, node_cases: Integers,
        rows: Integers, volumes: Floats, moduli: Floats, cell_cases: Integers, slots: Floats,
        starts: Integers,
        points: Floats, held: Integers, goals: Floats, anchors: Floats, states: Integers,
        point_forces: Floats, owners: Integers,
        poses: Floats, numbers: Floats, choices: Integers, coefficients: Floats,
        case_count: ti.i32, step: ti.i32,
    ):  # fmt: skip
        nodes = ti.static(
            Nodes(displacement, velocity, forces, masses, fixed, powers, node_slots, node_cases)
        )
        cells = ti.static(Cells(rows, volumes, moduli, cell_cases, slots, starts))
        surface = ti.static(Surface(points, held, goals, anchors, states, point_forces, owners))
        cases = ti.static(Cases(poses, numbers, choices, coefficients))
        # All bounds first: Taichi then finds them in one task instead of one before each loop.
        cell_count, node_count = cell_cases.shape[0], node_cases.shape[0]
        point_count = owners.shape[0]
        surface_pass(nodes, cells, surface, cases, point_count, case_count, step)
        cell_pass(nodes, cells, surface, cases, cell_count, linear)
        node_pass(nodes, cells, cases, node_count)

    return substep


@functools.cache
def tied_substep_of(linear):
    """The same for cells of several levels, whose nodes may be tied."""

    @ti.kernel
    def tied_substep(
        displacement: Floats, velocity: Floats, forces: Floats, masses: Floats, fixed: Integers,
        powers: Floats, node_slots: Integers, node_cases: Integers,
        rows: Integers, volumes: Floats, moduli: Floats, cell_cases: Integers, slots: Floats,
        starts: Integers,
        points: Floats, held: Integers, goals: Floats, anchors: Floats, states: Integers,
        point_forces: Floats, owners: Integers,
        poses: Floats, numbers: Floats, choices: Integers, coefficients: Floats,
        tied: Integers, leader_starts: Integers, leaders: Integers, leader_shares: Floats,
        apart: Integers, leading: Integers,
        follower_starts: Integers, followers: Integers, follower_shares: Floats,
        case_count: ti.i32, step: ti.i32,
    ):  # fmt: skip
        nodes = ti.static(
            Nodes(displacement, velocity, forces, masses, fixed, powers, node_slots, node_cases)
        )
        cells = ti.static(Cells(rows, volumes, moduli, cell_cases, slots, starts))
        surface = ti.static(Surface(points, held, goals, anchors, states, point_forces, owners))
        cases = ti.static(Cases(poses, numbers, choices, coefficients))
        ties = ti.static(
            Ties(
                tied, leader_starts, leaders, leader_shares, apart, leading,
                follower_starts, followers, follower_shares,
            )
        )  # fmt: skip
        cell_count, node_count = cell_cases.shape[0], node_cases.shape[0]
        point_count, tied_count, leading_count = owners.shape[0], tied.shape[0], leading.shape[0]
        surface_pass(nodes, cells, surface, cases, point_count, case_count, step)
        cell_pass(nodes, cells, surface, cases, cell_count, linear)
        tied_forces_pass(nodes, cells, cases, ties, tied_count)
        free_node_pass(nodes, cells, cases, ties, node_count)
        leader_pass(nodes, cells, cases, ties, leading_count)
        tied_moves_pass(nodes, cases, ties, tied_count)

    return tied_substep


@ti.kernel
def commit_anchors(
    nodes: pack_of(Nodes),
    cells: pack_of(Cells),
    surface: pack_of(Surface),
    cases: pack_of(Cases),
    slips: Floats,
    kept: Floats,
    sliding: Floats,
):
    """Close a settled frame of cases, by their poses in the first step of the table.

    Their displacement is copied to `kept`, 3 N.
    Anchors follow the points that slid, and the way they go is added to `slips`; contacts become
    history. Those that went farther than the case's entry of `sliding` [mm] are held by kinetic
    friction from here on; a case whose entry is negative is left alone.
    """
    for node in range(nodes.node_cases.shape[0]):
        if sliding[nodes.node_cases[node]] >= 0.0:
            for c in ti.static(range(3)):
                kept[3 * node + c] = nodes.displacement[3 * node + c]
    for cell in range(cells.cell_cases.shape[0]):
        case = cells.cell_cases[cell]
        if sliding[case] >= 0.0:
            rotation = body_rotation(cases, case)
            for point in range(cells.starts[cell], cells.starts[cell + 1]):
                if surface.held[point] == MEETS_RIGID:
                    place = point_displacement(nodes, cells, surface, cell, point)
                    place = place_in_body(point, place, surface, cases, rotation, case)
                    distance, gradient = object_distance(place, cases, case)
                    if distance < 0.0 and surface.states[point] != FREE:
                        anchor = place
                        for c in ti.static(range(3)):
                            anchor[c] = surface.anchors[3 * point + c]
                        friction = friction_now(point, surface, cases, case)
                        limit = -friction * distance * gradient.norm()
                        new = place - tangent_slip(place, gradient, anchor, limit)
                        way = new - anchor
                        normal = gradient / ti.max(gradient.norm(), 1e-9)
                        length = (way - way.dot(normal) * normal).norm()
                        slips[point] += length
                        surface.states[point] = HELD
                        if length > sliding[case]:
                            surface.states[point] = SLID
                        for c in ti.static(range(3)):
                            surface.anchors[3 * point + c] = new[c]
                    else:
                        surface.states[point] = FREE
