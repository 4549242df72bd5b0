"""What surrounds the solution of a frame: who may touch, their compliance, what is felt after."""

# Taichi reads annotations and operators in its own way.
# pyright: reportInvalidTypeForm=false, reportGeneralTypeIssues=false, reportIndexIssue=false

import taichi as ti
import taichi.math as tm

from sim.condensed.bundles import (
    DEEPEST,
    FORCE,
    MOMENT,
    RATIO,
    SLIDES,
    SLIDING,
    STICKS,
    TOTALS,
    TOUCHING,
    Choice,
    Felt,
    Memory,
    Object,
    Rules,
    Skin,
    Work,
)
from sim.condensed.functions import (
    block_of,
    decoupled,
    distance_at,
    origin_of,
    rotation_of,
    share_of,
    turned,
    wait,
)
from sim.optics.light.kernel_types import Floats, Integers

MARGIN = 0.45
"""Distance at which a node may come to touch within a frame [mm]: that of its spots, and .15."""
BLEND_MM = 1.0
"""Distance from what touches at which the whole compliance tells the displacement."""
STIFFENED = 0.15
"""Share of a node's own compliance that its spots take over (`solve_kernel`); what is left stays
positive definite below .25 (wall of 2 mm, nodes .6 mm apart)."""


@ti.kernel
def mark(presses: ti.i32, now: Floats, skin: Skin, thing: Object, past: Memory, marks: Integers):
    """Mark the nodes that may touch, (B N,): near the object at rest and as they were left."""
    nodes = skin.points.shape[0]
    for at in range(presses * nodes):
        press, node = at // nodes, at % nodes
        origin = origin_of(now, press)
        marks[at] = 0
        if (skin.points[node] - origin).norm() < thing.reach + MARGIN:
            rotation = rotation_of(now, press)
            at_rest, _ = distance_at(skin.points[node], origin, rotation, thing)
            if at_rest < MARGIN:
                left = skin.points[node] + past.settled[at]
                gap, _ = distance_at(left, origin, rotation, thing)
                marks[at] = ti.cast(gap < MARGIN or past.held[at] > 0, ti.i32)


@ti.kernel
def count_marks(presses: ti.i32, nodes: ti.i32, marks: Integers, counts: Integers):
    """How many nodes each press has marked."""
    ti.loop_config(block_dim=1)
    for press in range(presses):
        total = 0
        for node in range(nodes):
            total += marks[press * nodes + node]
        counts[press] = total


@ti.kernel
def choose(
    presses: ti.i32,
    now: Floats,
    skin: Skin,
    thing: Object,
    past: Memory,
    marks: Integers,
    chosen: Choice,
    work: Work,
    rules: Rules,
):
    """Number the candidates of each press and begin with the forces and anchors of the last frame.

    `slips` becomes the way from its anchor that a node would have slid if it stayed where it is at
    rest; a node that touches anew counts only the share of the way after touching.
    """
    nodes = skin.points.shape[0]
    ti.loop_config(block_dim=1)
    for press in range(presses):
        number = 0
        for node in range(nodes):
            slot = -1
            if marks[press * nodes + node] == 1 and number < rules.most:
                slot = number
                chosen.candidates[press * rules.most + number] = node
                number += 1
            chosen.slots[press * nodes + node] = slot
    for at in range(presses * rules.most):
        press, number = at // rules.most, at % rules.most
        if number < ti.min(chosen.counts[press], rules.most):
            node = chosen.candidates[at]
            entry = press * nodes + node
            rest = skin.points[node]
            origin, rotation = origin_of(now, press), rotation_of(now, press)
            tie = rest
            if past.held[entry] > 0:
                tie = rotation @ past.anchor[entry] + origin
            elif past.known[press] == 1:
                left = rest + past.settled[entry]
                before, turn = origin_of(past.poses, press), rotation_of(past.poses, press)
                carried = rotation @ (turn.transpose() @ (left - before)) + origin
                gap, _ = distance_at(left, before, turn, thing)
                deep, _ = distance_at(rest, origin, rotation, thing)
                open_mm = ti.max(gap, 0.0)
                share = open_mm / ti.max(open_mm - ti.min(deep, -1e-6), 1e-6)
                tie = carried + share * (left - carried)
            work.slips[at] = rest - tie
            work.slid[at] = 0
            for c in ti.static(range(3)):
                work.pushes[3 * at + c] = past.force[entry][c]


@ti.kernel
def gather(presses: ti.i32, skin: Skin, chosen: Choice, work: Work, rules: Rules):
    """Compliance among the candidates, decoupled, column by column."""
    nodes, room = skin.points.shape[0], rules.most
    for at in range(presses * room):
        press, number = at // room, at % room
        count = ti.min(chosen.counts[press], room)
        if number < count:
            first = 9 * room * (press * room + number)
            for k in range(9 * room):
                work.columns[first + k] = 0.0
            node = chosen.candidates[at]
            for pair in range(skin.row_starts[node], skin.row_starts[node + 1]):
                other = skin.row_nodes[pair]
                slot = chosen.slots[press * nodes + other]
                if slot >= 0:
                    # A row tells how its node moves: turned, how the neighbour does.
                    block = block_of(skin, pair).transpose()
                    block = decoupled(block, skin.normals[other], skin.normals[node])
                    if other == node:
                        normal = skin.normals[node]
                        less = STIFFENED * skin.own_mm_N[node]
                        block -= less * normal.outer_product(normal)
                    for i, j in ti.static(ti.ndrange(3, 3)):
                        work.columns[first + 3 * room * j + 3 * slot + i] = block[i, j]


@ti.kernel
def spread(
    presses: ti.i32,
    skin: Skin,
    chosen: Choice,
    work: Work,
    past: Memory,
    felt: Felt,
    rules: Rules,
    lanes: ti.template(),
):
    """Displacement of all nodes: as solved near what touches, by the whole compliance beyond.

    `lanes` threads a press; of a node that pushes each takes other neighbours, so that sums are in
    the order of the candidates whatever the number. What is solved for leaves out that a dent
    pushes its surroundings outwards; the whole compliance has too much of that where the object is.
    """
    nodes = skin.points.shape[0]
    for at in range(presses * nodes):
        past.settled[at] = tm.vec3(0.0)
        felt.full[at] = tm.vec3(0.0)
        felt.away[at] = BLEND_MM
    ti.loop_config(block_dim=lanes)
    for thread in range(presses * lanes):
        press, lane = thread // lanes, thread % lanes
        first = press * rules.most
        for number in range(ti.min(chosen.counts[press], rules.most)):
            push = tm.vec3(0.0)
            for c in ti.static(range(3)):
                push[c] = work.pushes[3 * (first + number) + c]
            if push.norm() > 0.0:
                node = chosen.candidates[first + number]
                begin = skin.row_starts[node]
                for k in range(share_of(skin.row_starts[node + 1] - begin, lane, lanes)):
                    pair = begin + lane + lanes * k
                    other = skin.row_nodes[pair]
                    entry = press * nodes + other
                    block = block_of(skin, pair).transpose()
                    felt.full[entry] += block @ push
                    bare = decoupled(block, skin.normals[other], skin.normals[node])
                    past.settled[entry] += bare @ push
                    far = (skin.points[other] - skin.points[node]).norm()
                    felt.away[entry] = ti.min(felt.away[entry], far)
            wait(lanes)
    for at in range(presses * nodes):
        share = felt.away[at] / BLEND_MM
        felt.displacement[at] = (1.0 - share) * past.settled[at] + share * felt.full[at]


@ti.func
def hardened(s, sharpness, a, b, c):
    """Factor of a force at an indentation over the wall s."""
    return (1.0 + a * s + b * s * s) * (1.0 + c * sharpness)


@ti.kernel
def feel(
    presses: ti.i32,
    now: Floats,
    skin: Skin,
    thing: Object,
    past: Memory,
    chosen: Choice,
    work: Work,
    felt: Felt,
    rules: Rules,
):
    """Harden the forces, add them up, and remember the frame."""
    nodes, room = skin.points.shape[0], rules.most
    for at in range(presses * nodes):
        past.force[at] = tm.vec3(0.0)
        past.held[at] = 0
        felt.pressure[at] = 0.0
        felt.traction[at] = tm.vec3(0.0)
    ti.loop_config(block_dim=1)
    for press in range(presses):
        origin, rotation = origin_of(now, press), rotation_of(now, press)
        load, moment, worst, ratio = tm.vec3(0.0), tm.vec3(0.0), 0.0, 0.0
        pressing, sliding, touching = 0.0, 0.0, 0
        for number in range(ti.min(chosen.counts[press], room)):
            at = press * room + number
            node = chosen.candidates[at]
            entry = press * nodes + node
            push, moved = tm.vec3(0.0), tm.vec3(0.0)
            for c in ti.static(range(3)):
                push[c] = work.pushes[3 * at + c]
                moved[c] = work.moves[3 * at + c]
            normal, way = skin.normals[node], work.ways[at]
            along = -push.dot(normal)
            if along > 0.0:
                touching += 1
                place = skin.points[node] + moved
                s = ti.max(-moved.dot(normal) / skin.walls[node], 0.0)
                worst = ti.max(worst, s)
                s = ti.min(s, rules.deepest)
                across = turned(push + along * normal, -normal, way)
                ratio = ti.max(ratio, across.norm() / along)
                slides = work.slid[at] == 1
                by_normal = hardened(
                    s, thing.sharpness, rules.normal_a, rules.normal_b, rules.normal_c
                )
                by_side = by_normal
                if not slides:
                    by_side = hardened(
                        s,
                        thing.sharpness,
                        rules.tangential_a,
                        rules.tangential_b,
                        rules.tangential_c,
                    )
                hard = by_normal * along * way + by_side * across
                felt.traction[entry] = hard
                felt.pressure[entry] = by_normal * along / skin.areas[node]
                load -= hard
                moment -= (place - origin).cross(hard)
                pressing += by_normal * along
                if slides:
                    sliding += by_normal * along
                past.force[entry] = push
                past.held[entry], tie = SLIDES, place
                if not slides:
                    past.held[entry], tie = STICKS, skin.points[node] - work.slips[at]
                past.anchor[entry] = rotation.transpose() @ (tie - origin)
        first = TOTALS * press
        for c in ti.static(range(3)):
            felt.totals[first + FORCE + c] = load[c]
            felt.totals[first + MOMENT + c] = moment[c]
        felt.totals[first + DEEPEST] = worst
        felt.totals[first + RATIO] = ratio
        felt.totals[first + SLIDING] = sliding / ti.max(pressing, 1e-12)
        felt.totals[first + TOUCHING] = ti.cast(touching, ti.f32)
        for c in ti.static(range(7)):
            past.poses[7 * press + c] = now[7 * press + c]
        past.known[press] = 1
