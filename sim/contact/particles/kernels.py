"""Taichi kernels of the published method (`particles`): one substep of APIC material points.

Lengths are in cells, times in substeps, masses in full material points. The scatter adds 64-bit
fixed-point numbers, whose sum does not depend on the order: results are the same bit by bit
whatever the thread count. The plain twin is `particle_reference`.
"""

# Taichi reads annotations and operators in its own way.
# pyright: reportInvalidTypeForm=false, reportGeneralTypeIssues=false, reportIndexIssue=false

import taichi as ti

from sim.contact.engine.bundles import Floats, Integers

FIXED_POINT = float(1 << 36)
"""Units in one cell per substep times the mass of a point: 1.5e-11."""
GROUPS = 3
"""Sums of momentum are kept for the object, the support and the border of the region."""
OBJECT, SUPPORT, BORDER, FREE = 0, 1, 2, 3
"""What a point is: part of the object, held at the support, held at the border, or free."""

Longs = ti.types.ndarray(dtype=ti.i64, ndim=1)

Points = ti.types.argpack(
    places=Floats,
    speeds=Floats,
    affine=Floats,
    gradients=Floats,
    masses=Floats,
    moduli=Floats,
    kinds=Integers,
)
"""Of the membrane's P points: places and speeds (3 P), affine velocities C and deformation
gradients F (9 P), masses (P), shear and bulk moduli [MPa] (2 P), SUPPORT, BORDER or FREE (P)."""
Body = ti.types.argpack(offsets=Floats, poses=Floats, object_mass=ti.f32)
"""Of the object's Q points: places in its frame (3 Q), its place and rotation by substep (12 each),
and the mass of a point."""
Grid = ti.types.argpack(momentum=Longs, flow=Floats, nodes_y=ti.i32, nodes_z=ti.i32)
"""Of M nodes: mass and momentum in fixed point (4 M), velocity (3 M), and nodes along y and z."""


@ti.func
def _weights(local):
    """Weights of three nodes at a distance of 0.5 to 1.5 from the first, as rows."""
    return ti.Matrix.rows(
        [0.5 * (1.5 - local) ** 2, 0.75 - (local - 1.0) ** 2, 0.5 * (local - 0.5) ** 2]
    )


@ti.func
def _fixed(value):
    return ti.cast(ti.floor(value * FIXED_POINT + 0.5), ti.i64)


@ti.func
def _place(places: ti.template(), point):
    return ti.Vector([places[3 * point + c] for c in range(3)])


@ti.func
def _tensor(tensors: ti.template(), point):
    return ti.Matrix([[tensors[9 * point + 3 * r + c] for c in range(3)] for r in range(3)])


@ti.func
def kirchhoff(gradient, shear, bulk):
    """tau = mu J^(-2/3) dev(F F^T) + K (J - 1) J I."""
    ratio = gradient.determinant()
    left = gradient @ gradient.transpose()
    guarded = ti.max(ratio, 1e-3)
    scale = shear * ti.exp(-2.0 / 3.0 * ti.log(guarded))
    pressure = bulk * (ratio - 1.0) * ratio - scale * left.trace() / 3.0
    return scale * left + pressure * ti.Matrix.identity(ti.f32, 3)


@ti.func
def _object_place(body: ti.template(), point, step):
    base = 12 * step
    place = ti.Vector([body.poses[base + c] for c in range(3)])
    for r in ti.static(range(3)):
        for c in ti.static(range(3)):
            place[r] += body.poses[base + 3 + 3 * r + c] * body.offsets[3 * point + c]
    return place


@ti.kernel
def substep(
    points: Points, body: Body, grid: Grid, sums: Longs, step: ti.i32, stress_scale: ti.f32
):
    """Points to grid, grid velocities, grid to points, prescribed points.

    `points` are the membrane's; the object's follow rows `step` and `step` + 1 of the pose table.
    Momentum that prescribed points would have gained goes into `sums`.
    """
    count, object_points = points.kinds.shape[0], body.offsets.shape[0] // 3
    for entry in range(grid.momentum.shape[0]):
        grid.momentum[entry] = ti.cast(0, ti.i64)
    for point in range(count + object_points):
        place, speed = ti.Vector([0.0, 0.0, 0.0]), ti.Vector([0.0, 0.0, 0.0])
        carried = ti.Matrix.zero(ti.f32, 3, 3)
        mass = body.object_mass
        if point < count:
            place, speed = _place(points.places, point), _place(points.speeds, point)
            mass = points.masses[point]
            shear, bulk = points.moduli[2 * point], points.moduli[2 * point + 1]
            stress = kirchhoff(_tensor(points.gradients, point), shear, bulk)
            carried = mass * (_tensor(points.affine, point) - 4.0 * stress_scale * stress)
        else:
            place = _object_place(body, point - count, step)
            speed = _object_place(body, point - count, step + 1) - place
        first = ti.cast(ti.floor(place - 0.5), ti.i32)
        local = place - ti.cast(first, ti.f32)
        weights = _weights(local)
        for i, j, k in ti.static(ti.ndrange(3, 3, 3)):
            weight = weights[i, 0] * weights[j, 1] * weights[k, 2]
            arm = ti.Vector([float(i), float(j), float(k)]) - local
            added = weight * (mass * speed + carried @ arm)
            node = ((first[0] + i) * grid.nodes_y + first[1] + j) * grid.nodes_z + first[2] + k
            grid.momentum[4 * node] += _fixed(weight * mass)
            for c in ti.static(range(3)):
                grid.momentum[4 * node + 1 + c] += _fixed(added[c])
    for node in range(grid.momentum.shape[0] // 4):
        mass = ti.cast(grid.momentum[4 * node], ti.f32)
        for c in ti.static(range(3)):
            grid.flow[3 * node + c] = 0.0
            if mass > 0.0:
                grid.flow[3 * node + c] = ti.cast(grid.momentum[4 * node + 1 + c], ti.f32) / mass
    for point in range(count + object_points):
        place, given, mass, kind = ti.Vector([0.0, 0.0, 0.0]), ti.Vector([0.0, 0.0, 0.0]), 0.0, 0
        if point < count:
            place = _place(points.places, point)
            mass, kind = points.masses[point], points.kinds[point]
        else:
            place = _object_place(body, point - count, step)
            given = _object_place(body, point - count, step + 1) - place
            mass = body.object_mass
        first = ti.cast(ti.floor(place - 0.5), ti.i32)
        local = place - ti.cast(first, ti.f32)
        weights = _weights(local)
        speed, gradient = ti.Vector([0.0, 0.0, 0.0]), ti.Matrix.zero(ti.f32, 3, 3)
        for i, j, k in ti.static(ti.ndrange(3, 3, 3)):
            weight = weights[i, 0] * weights[j, 1] * weights[k, 2]
            arm = ti.Vector([float(i), float(j), float(k)]) - local
            node = ((first[0] + i) * grid.nodes_y + first[1] + j) * grid.nodes_z + first[2] + k
            moved = ti.Vector([grid.flow[3 * node + c] for c in range(3)])
            speed += weight * moved
            gradient += 4.0 * weight * moved.outer_product(arm)
        if kind != FREE:
            gain, at = mass * (speed - given), place
            turning = at.cross(gain)
            for c in ti.static(range(3)):
                sums[6 * kind + c] += _fixed(gain[c])
                sums[6 * kind + 3 + c] += _fixed(turning[c])
        if point < count:
            now = _tensor(points.gradients, point)
            now += gradient @ now
            if kind != FREE:
                speed, gradient = given, ti.Matrix.zero(ti.f32, 3, 3)
            for r in ti.static(range(3)):
                points.speeds[3 * point + r] = speed[r]
                points.places[3 * point + r] = place[r] + speed[r]
                for c in ti.static(range(3)):
                    points.gradients[9 * point + 3 * r + c] = now[r, c]
                    points.affine[9 * point + 3 * r + c] = gradient[r, c]
