"""Arrays of a batch that travel together through the kernels of a substep, as one argument each.

A function of Taichi takes a bundle as a template. A kernel that is launched takes it as a pack
(`pack_of`); a kernel in a compute graph takes all arrays, since a graph knows no packs, and bundles
them while it is compiled. No two bundles share a name: Taichi gives nothing for an array whose
name another pack of the kernel has too.

A batch has N nodes, C cells, P surface points and B cases, padding included; tables of several
columns per node or cell interleave (`batch.interleaved`).
"""

# Taichi reads annotations in its own way, so they may not be put off to the future.
# pyright: reportInvalidTypeForm=false, reportGeneralTypeIssues=false, reportCallIssue=false

import functools
from typing import Any, NamedTuple

import taichi as ti

Floats = ti.types.ndarray(dtype=ti.f32, ndim=1)
Integers = ti.types.ndarray(dtype=ti.i32, ndim=1)


class Nodes(NamedTuple):
    """What moves, and where its forces come from."""

    displacement: Floats
    """[mm], 3 N."""
    velocity: Floats
    """[mm per substep], 3 N."""
    forces: Floats
    """Of the last substep [N], 3 N."""
    masses: Floats
    """Fictitious masses, N."""
    fixed: Integers
    """Whether a node stays where it is, N."""
    powers: Floats
    """Work and inertia of the last substep, 2 N."""
    node_slots: Integers
    """Slots of the 27 cells around a node, 27 N."""
    node_cases: Integers
    """Case of each node, N."""


class Cells(NamedTuple):
    """What is strained."""

    rows: Integers
    """First nodes of the nine rows of three nodes, 9 C."""
    volumes: Floats
    """Of the eight points [mm^3], 8 C."""
    moduli: Floats
    """Shear and bulk modulus [MPa], and one over the cell's edge [1/mm], 3 C."""
    cell_cases: Integers
    """Case of each cell, C."""
    slots: Floats
    """Forces of a cell on its 27 nodes [N], 81 C and a block of zeros."""
    starts: Integers
    """First surface point of each cell, then P: C + 1."""


class Ties(NamedTuple):
    """Which nodes follow others; of S tied nodes with L leaders in all."""

    tied: Integers
    """Tied nodes, S."""
    leader_starts: Integers
    """First leader of each, then L: S + 1."""
    leaders: Integers
    """Nodes, L."""
    leader_shares: Floats
    """Of each leader in its follower, L."""
    apart: Integers
    """1 where a node is tied or leads others, N."""
    leading: Integers
    """Nodes that lead others, in order, M."""
    follower_starts: Integers
    """First follower of each of these, then L: M + 1."""
    followers: Integers
    """Tied nodes by leader, L."""
    follower_shares: Floats
    """Of the leader in each follower, L."""


class Surface(NamedTuple):
    """What is held, or meets the object."""

    points: Floats
    """Constants of a surface point (`layout.POINT`), 11 P."""
    held: Integers
    """What a point meets, or that it is held, P."""
    goals: Floats
    """Where held points belong at share 0 and 1 of a frame [mm], 6 P."""
    anchors: Floats
    """Where friction holds a point, in the body frame [mm], 3 P."""
    states: Integers
    """FREE, TOUCHED, HELD or SLID, P."""
    point_forces: Floats
    """On the membrane in the last substep [N], 3 P."""
    owners: Integers
    """Cell that each point lies in, P; a single -1 where there is no point."""


class Cases(NamedTuple):
    """What differs between presses: tables of `layout`."""

    poses: Floats
    """Of the objects, by substep and case, 13 B for each substep."""
    numbers: Floats
    """13 B."""
    choices: Integers
    """6 B."""
    coefficients: Floats
    """Samples of all objects, one after the other."""


@functools.cache
def pack_of(kind: type[Any]) -> Any:
    """The type of argument by which a launched kernel takes a kind of bundle."""
    return ti.types.argpack(**kind.__annotations__)


def packed(bundle: Any) -> Any:
    """A bundle as the argument of a launched kernel; making one takes longer than a launch."""
    return pack_of(type(bundle))(**bundle._asdict())
