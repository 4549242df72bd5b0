"""The forces of a frame: rounds of looking at the gap, and block Gauss-Seidel within each.

Unknown are the forces f of the candidates; u = G f moves them. Each spot p of a node, of area A_p,
lies at a gap g_p from the object along the node's push direction n, when the node has moved by d
along it g_p + d. The node's normal force is that of the spots that overlap,

    l = k sum_p A_p max(0, -(g_p + d)),    k = 1 / (STIFFNESS c_nn A),

c_nn the node's own compliance and A its area: a node takes up its force over the way that its
surroundings take to be covered. G is stiffened by as much
(`frame_kernels.STIFFENED`), so that covered nodes move as the
wall does. Coulomb's law ties a node to its tie: the tangential force follows the way from
it, at most friction times l (Moreau 1988, solved node after node as Jean 1999 does).

f is kept in the frame of its node: as far as the push direction is turned from the inward normal,
the force is turned back (`functions.turned`). A skin that gives way turns with the object, and so
does what it answers to a pressure; a linear skin, pushed askew, would flow from under a ball and
slide where a true one sticks.
"""

# Taichi reads annotations and operators in its own way.
# pyright: reportInvalidTypeForm=false, reportGeneralTypeIssues=false, reportIndexIssue=false
# pyright: reportOptionalCall=false

import taichi as ti
import taichi.math as tm

from sim.condensed.bundles import (
    MOVED,
    SWEEPS,
    TOTALS,
    Choice,
    Felt,
    Memory,
    Object,
    Rules,
    Skin,
    Work,
)
from sim.condensed.functions import (
    clamped,
    distance_at,
    origin_of,
    rotation_of,
    share_of,
    turned,
    wait,
)
from sim.optics.light.kernel_types import Floats

SOFTNESS = 0.15
"""Compliance of the spots of a node over the node's own [1]."""
SPOT = 2.0 / 3.0
"""Weight of its own node at a spot, and of each other corner of its triangle 1/6."""
ROUNDS, SWEEPS_A_ROUND = 6, 60
SETTLED_MM, STILL_MM = 2e-3, 2e-4
"""Change of a round, and of a sweep, at which they end [mm]."""
TANGENTIAL = 0.6
"""Tangential compliance of a node over the trace of its block less the normal part."""
NEWTON = 4


@ti.kernel
def solve(
    presses: ti.i32,
    now: Floats,
    skin: Skin,
    thing: Object,
    past: Memory,
    chosen: Choice,
    work: Work,
    felt: Felt,
    rules: Rules,
    lanes: ti.template(),
):
    """Fill `pushes`, `moves`, `ways`, `slid` of all candidates; `lanes` threads a press."""
    ti.loop_config(block_dim=lanes)
    for thread in range(presses * lanes):
        press, lane = thread // lanes, thread % lanes
        room = rules.most
        count, first = ti.min(chosen.counts[press], room), press * room
        moved, swept = 0.0, 0
        if count > 0:
            origin, rotation = origin_of(now, press), rotation_of(now, press)
            motion(count, first, lane, lanes, work, room)
            wait(lanes)
            going, rounds = True, 0
            while going and rounds < ROUNDS:
                for k in range(share_of(count, lane, lanes)):
                    at = first + lane + lanes * k
                    look(at, press, origin, rotation, skin, thing, past, chosen, work, rules)
                wait(lanes)
                for k in range(share_of(3 * count, lane, lanes)):
                    entry = 3 * first + lane + lanes * k
                    work.starts[entry] = work.moves[entry]
                wait(lanes)
                change, sweeps = 1.0, 0
                while change > STILL_MM and sweeps < SWEEPS_A_ROUND:
                    change = 0.0
                    for number in range(count):
                        at = first + number
                        step = pushed(at, press, skin, chosen, work, rules)
                        wait(lanes)
                        size = ti.abs(step).max()
                        if size > 0.0:
                            column = 9 * room * at
                            own = 0.0
                            for c in ti.static(range(3)):
                                own += work.columns[column + 3 * room * c + 3 * number + c]
                            change = ti.max(change, own * size)
                            for k in range(share_of(3 * count, lane, lanes)):
                                entry = lane + lanes * k
                                work.moves[3 * first + entry] += (
                                    work.columns[column + entry] * step[0]
                                    + work.columns[column + 3 * room + entry] * step[1]
                                    + work.columns[column + 6 * room + entry] * step[2]
                                )
                            if lane == 0:
                                for c in ti.static(range(3)):
                                    work.pushes[3 * at + c] += step[c]
                        wait(lanes)
                    sweeps += 1
                swept += sweeps
                moved = 0.0
                for entry in range(3 * first, 3 * (first + count)):
                    moved = ti.max(moved, ti.abs(work.moves[entry] - work.starts[entry]))
                rounds += 1
                going = moved > SETTLED_MM
                wait(lanes)
        if lane == 0:
            felt.totals[TOTALS * press + MOVED] = moved
            felt.totals[TOTALS * press + SWEEPS] = ti.cast(swept, ti.f32)


@ti.func
def motion(count, first, lane, lanes: ti.template(), work: ti.template(), room):
    """Displacement of the candidates by the forces that they begin with."""
    for k in range(share_of(3 * count, lane, lanes)):
        work.moves[3 * first + lane + lanes * k] = 0.0
    for source in range(3 * first, 3 * (first + count)):
        load = work.pushes[source]
        if load != 0.0:
            column = 3 * room * source
            for k in range(share_of(3 * count, lane, lanes)):
                entry = lane + lanes * k
                work.moves[3 * first + entry] += work.columns[column + entry] * load


@ti.func
def displaced(entry, press, room, past: ti.template(), chosen: ti.template(), work: ti.template()):
    """Displacement of a press's node now [mm]; one that is no candidate stays as it was left."""
    slot = chosen.slots[entry]
    found = past.settled[entry]
    if slot >= 0:
        for c in ti.static(range(3)):
            found[c] = work.moves[3 * (press * room + slot) + c]
    return found


@ti.func
def look(
    at,
    press,
    origin,
    rotation,
    skin: ti.template(),
    thing: ti.template(),
    past: ti.template(),
    chosen: ti.template(),
    work: ti.template(),
    rules: ti.template(),
):
    """Gap of each spot of a candidate, and the direction in which it is pushed: the mean of its
    spots', those within .05 mm of the object most."""
    node, base = chosen.candidates[at], press * skin.points.shape[0]
    inward = -skin.normals[node]
    own = displaced(base + node, press, rules.most, past, chosen, work)
    total = tm.vec3(0.0)
    begin = skin.spot_starts[node]
    for spot in range(begin, skin.spot_starts[node + 1]):
        place = SPOT * (skin.points[node] + own)
        for k in ti.static(range(2)):
            other = skin.spot_others[2 * spot + k]
            shift = displaced(base + other, press, rules.most, past, chosen, work)
            place += 0.5 * (1.0 - SPOT) * (skin.points[other] + shift)
        gap, way = distance_at(place, origin, rotation, thing)
        gap, way = clamped(gap, way, inward)
        work.gaps[at * rules.spots + spot - begin] = gap
        total += skin.spot_areas[spot] * ti.exp(-ti.max(gap, 0.0) / 0.05) * way
    length = total.norm()
    seen = total / ti.max(length, 1e-12)
    if length <= 1e-12:
        gap, way = distance_at(skin.points[node] + own, origin, rotation, thing)
        gap, seen = clamped(gap, way, inward)
    work.ways[at] = seen


@ti.func
def pushed(
    at,
    press,
    skin: ti.template(),
    chosen: ti.template(),
    work: ti.template(),
    rules: ti.template(),
):
    """Change of the force on a candidate [N], in its own frame, that settles it, the others as they
    are."""
    node = chosen.candidates[at]
    room = rules.most
    number = at % room
    way = work.ways[at]
    load, moved = tm.vec3(0.0), tm.vec3(0.0)
    own = ti.Matrix.zero(ti.f32, 3, 3)
    for i in ti.static(range(3)):
        load[i] = work.pushes[3 * at + i]
        moved[i] = work.moves[3 * at + i] - work.starts[3 * at + i]
        for j in ti.static(range(3)):
            own[i, j] = work.columns[9 * room * at + 3 * room * j + 3 * number + i]
    inward = -skin.normals[node]
    response = own @ inward
    stiff = way.dot(response)
    before = load.dot(inward)
    after = before
    # Spots move with the corners beside them too; within a round all of a node move alike.
    beside = tm.vec3(0.0)
    begin, end = skin.spot_starts[node], skin.spot_starts[node + 1]
    for corner in range(2 * begin, 2 * end):
        slot = chosen.slots[press * skin.points.shape[0] + skin.spot_others[corner]]
        if slot >= 0:
            entry = 3 * (press * room + slot)
            for i in ti.static(range(3)):
                beside[i] += work.moves[entry + i] - work.starts[entry + i]
    beside /= ti.cast(2 * (end - begin), ti.f32)
    along = way.dot(SPOT * moved + (1.0 - SPOT) * beside)
    softness = SOFTNESS * skin.own_mm_N[node] * skin.areas[node]
    gap = at * rules.spots
    for _ in range(NEWTON):
        covered, overlap = 0.0, 0.0
        for spot in range(begin, end):
            open_mm = work.gaps[gap + spot - begin] + along + stiff * (after - before)
            if open_mm < 0.0:
                covered += skin.spot_areas[spot]
                overlap -= skin.spot_areas[spot] * open_mm
        after -= (softness * after - overlap) / (softness + stiff * covered)
        after = ti.max(after, 0.0)
    found = after * inward
    if rules.friction > 0.0 and after > 0.0:
        slip = moved + response * (after - before)
        for i in ti.static(range(3)):
            slip[i] += work.slips[at][i] + work.starts[3 * at + i]
        slip -= slip.dot(way) * way
        soft = TANGENTIAL * (own.trace() - inward.dot(response))
        side = turned(load - before * inward, inward, way) - slip / soft
        size = side.norm()
        most_N = rules.friction * after
        if work.slid[at] == 1:
            most_N = rules.sliding_friction * after
        if size > most_N:
            work.slid[at] = 1
            side *= rules.sliding_friction * after / size
        else:
            work.slid[at] = 0
        found += turned(side, way, inward)
    return found - load
