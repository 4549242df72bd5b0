"""Arrays that travel together through the kernels of fast contact, as one argument each.

N nodes of the skin, Z pairs of neighbours, S spots, B presses side by side, each with at most M
candidates. Arrays of all presses are flat: entry press * N + node, or press * M + candidate.
"""

import taichi as ti

from sim.optics.light.kernel_types import Floats, Integers, Vectors

Skin = ti.types.argpack(
    points=Vectors,
    normals=Vectors,
    walls=Floats,
    areas=Floats,
    own_mm_N=Floats,
    row_starts=Integers,
    row_nodes=Integers,
    row_blocks=Floats,
    spot_starts=Integers,
    spot_others=Integers,
    spot_areas=Floats,
)
"""Nodes at rest, (N,): places [mm], outward unit normals, thickness of the wall [mm], area [mm2],
and displacement along the normal by a unit force along it [mm/N]. Rows of the compliance as in
`SkinColumns`: (N + 1,), (Z,), (9 Z,). Spots of each node from `spot_starts[node]` on: the two other
corners of the triangle it lies in, (2 S,), and its area, (S,)."""
Object = ti.types.argpack(
    shape=ti.i32,
    sizes=Floats,
    coefficients=Floats,
    sample_counts=Integers,
    seats=Floats,
    sharpness=ti.f32,
    reach=ti.f32,
)
"""A rigid object as `Collider`: shape number, seated size (8,), samples (flat) and how many along
each axis (3,), the seat in its frame (3,), sharpness as `Hardening` means it, and the radius about
its origin that holds it [mm]."""
Memory = ti.types.argpack(
    force=Vectors, settled=Vectors, anchor=Vectors, held=Integers, poses=Floats, known=Integers
)
"""What a press remembers of its last frame, all nodes (B N,): force [N] and displacement [mm] as
solved, place on the object that a sticking node is tied to (object frame), and whether it touched,
`STICKS` or `SLIDES`, or 0; the object's pose, (7 B,), and whether there is one, (B,)."""
Choice = ti.types.argpack(candidates=Integers, slots=Integers, counts=Integers)
"""Nodes that may touch in this frame, (B M,); of each node its place among these or -1, (B N,); how
many there are, (B,)."""
Work = ti.types.argpack(
    columns=Floats,
    pushes=Floats,
    moves=Floats,
    starts=Floats,
    ways=Vectors,
    gaps=Floats,
    slips=Vectors,
    slid=Integers,
)
"""Of candidates: compliance among them, column by column, (9 B M M,); forces [N] and displacements
[mm] now and when the gap was looked at, (3 B M,); direction in which each is pushed, (B M,); gap of
each spot [mm], (B M K,) for K spots at most; way that it has slid at the start of the round [mm],
(B M,); whether it has slid in this frame, (B M,)."""
Rules = ti.types.argpack(
    friction=ti.f32,
    sliding_friction=ti.f32,
    most=ti.i32,
    spots=ti.i32,
    normal_a=ti.f32,
    normal_b=ti.f32,
    normal_c=ti.f32,
    tangential_a=ti.f32,
    tangential_b=ti.f32,
    tangential_c=ti.f32,
    deepest=ti.f32,
)
"""Coefficients of friction, M, K, and the numbers of `Hardening`."""
Felt = ti.types.argpack(
    displacement=Vectors,
    full=Vectors,
    away=Floats,
    pressure=Floats,
    traction=Vectors,
    totals=Floats,
)
"""What comes out, all nodes (B N,): displacement [mm], that by the whole compliance, distance to
what touches [mm], pressure [MPa], force on the skin [N]; and `TOTALS` numbers a press."""
STICKS, SLIDES = 1, 2
TOTALS = 16
FORCE, MOMENT, DEEPEST, MOVED, SWEEPS, SLIDING, RATIO, TOUCHING = 0, 3, 6, 7, 8, 9, 10, 11
"""Where in them: force [N] and moment [N mm] on the object, largest indentation over the wall,
change of the last round [mm], sweeps, share of the normal force that slides, largest tangential
over normal force, nodes that touch."""
