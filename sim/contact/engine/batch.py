"""Several presses (cases) as one set of device arrays.

Every case keeps its own copy of its region; nodes, cells and surface points of the cases follow
each other. Cells and nodes of a case are padded to a multiple of `BLOCK`, so that its rows of the
interleaved tables stay together. What one case does cannot change a bit of another.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import Any

import numpy as np
import taichi as ti

from sim.contact.engine import sum_kernels
from sim.contact.engine.bundles import Cases, Cells, Nodes, Surface, Ties, packed
from sim.contact.engine.sums import Sums
from sim.contact.grid import layout
from sim.contact.objects.collider import Collider
from sim.contact.region.domain import BLOCK, NO_SLOT, Domain


@dataclass(frozen=True, kw_only=True, slots=True)
class Case:
    """One press: its region, its object, and the friction between them."""

    domain: Domain
    collider: Collider
    friction: float
    """Static coefficient."""
    kinetic_friction: float | None = None
    """That of points that slide; None: the static one."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Span:
    """Where a case lies in the arrays of a batch."""

    first_node: int
    nodes: int
    first_point: int
    points: int


class Batch:
    """Device arrays of all cases."""

    def __init__(self, cases: list[Case], steps: int) -> None:
        domains = [case.domain for case in cases]
        nodes = [_padded(len(domain.masses)) for domain in domains]
        cells = [_padded(len(domain.rows)) for domain in domains]
        points = [domain.points.count for domain in domains]
        node_at, cell_at, point_at = _starts(nodes), _starts(cells), _starts(points)
        self.spans = [
            Span(first_node=n, nodes=len(d.masses), first_point=p, points=d.points.count)
            for d, n, p in zip(domains, node_at, point_at, strict=False)
        ]
        everything = list(zip(domains, node_at, cell_at, point_at, strict=False))
        total = node_at[-1]
        nothing = 81 * cell_at[-1]
        slots = [
            interleaved(_shifted(d.node_slots, c, nothing), nothing) for d, _, c, _ in everything
        ]
        self.nodes = Nodes(
            displacement=floats(np.zeros(3 * total)),
            velocity=floats(np.zeros(3 * total)),
            forces=floats(np.zeros(3 * total)),
            # A padding node is fixed, and its mass only keeps it from dividing by nothing.
            masses=floats(_joined([_extended(d.masses, 1.0) for d in domains])),
            fixed=integers(_joined([_extended(_holds(d), layout.FIXED) for d in domains])),
            powers=floats(np.zeros(2 * total)),
            node_slots=integers(_joined(slots)),
            node_cases=integers(np.repeat(np.arange(len(cases)), nodes)),
        )
        counts = _joined([_points_per_cell(d) for d in domains])
        self.cells = Cells(
            rows=integers(_joined([interleaved(d.rows + n, n) for d, n, _, _ in everything])),
            volumes=floats(_joined([interleaved(d.volumes_mm3, 0.0) for d in domains])),
            moduli=floats(_joined([interleaved(_cell_table(d), 0.0) for d in domains])),
            cell_cases=integers(np.repeat(np.arange(len(cases)), cells)),
            # The block after the last cell stays zero: nodes without a cell on some side read it.
            slots=floats(np.zeros(81 * (cell_at[-1] + BLOCK))),
            starts=integers(np.concatenate([[0], np.cumsum(counts)])),
        )
        self.surface = Surface(
            points=floats(_joined([_point_table(d) for d in domains])),
            held=integers(_joined([d.points.bonded for d in domains])),
            goals=floats(np.zeros(6 * point_at[-1])),
            anchors=floats(np.zeros(3 * point_at[-1])),
            states=integers(np.zeros(point_at[-1])),
            point_forces=floats(np.zeros(3 * point_at[-1])),
            owners=integers(_owners(counts)),
        )
        self.kept = floats(np.zeros(3 * total))
        """Displacement at the last commit of each case [mm], 3 N."""
        self.slips = floats(np.zeros(point_at[-1]))
        """Way that each surface point has slid in settled frames [mm], P."""
        self.ties = _shared_ties(domains, node_at)
        """Which nodes follow others; None where none does."""
        samples, self.first_coefficients = _shared_samples(cases)
        self.cases = Cases(
            poses=floats(np.zeros(steps * len(cases) * layout.POSE)),
            numbers=floats(np.zeros(len(cases) * layout.NUMBERS)),
            choices=integers(np.zeros(len(cases) * layout.CHOICES)),
            coefficients=floats(samples),
        )
        self.packs = (
            packed(self.nodes), packed(self.cells), packed(self.surface), packed(self.cases),
        )  # fmt: skip
        """The bundles as arguments of launched kernels."""
        self.sums = Sums(self.nodes, self.surface, node_at, point_at)
        self._staging = floats(np.zeros(max(3 * max(nodes), 6 * max(points), 1)))

    @property
    def bundles(self) -> tuple[Any, ...]:
        """What the kernels of a substep take."""
        ties = () if self.ties is None else (self.ties,)
        return self.nodes, self.cells, self.surface, self.cases, *ties

    def read(self, array: Any, first: int, count: int) -> np.ndarray:
        """Some entries of a device array of floats, shape (count,)."""
        sum_kernels.copy_out(array, self._staging, first, count)
        return self._staging.to_numpy()[:count]

    def read_whole(self, array: Any, first: int, count: int) -> np.ndarray:
        """Some entries of a device array of small integers, shape (count,)."""
        sum_kernels.copy_whole_out(array, self._staging, first, count)
        return self._staging.to_numpy()[:count].astype(np.int32)

    def write(self, array: Any, first: int, values: np.ndarray) -> None:
        """Replace some entries of a device array of floats."""
        staged = np.zeros(self._staging.shape[0], np.float32)
        staged[: values.size] = values.ravel()
        self._staging.from_numpy(staged)
        sum_kernels.copy_in(self._staging, array, first, values.size)


def needed_bytes(cells: int, points: int) -> int:
    """Device memory that a case of so many cells and surface points takes, at most.

    A cell has 81 slots, 9 rows, 8 volumes, 2 moduli, its edge and case; there are up to twice as
    many nodes as cells in a thin wall, of 3 x 3 floats and 7 numbers, and 27 slot entries per cell.
    """
    per_cell = 4 * (81 + 9 + 8 + 4 + 27 + 2 * (9 + 7))
    per_point = 4 * (3 + 3 + 1 + 3 + 1 + 1 + 6 + 3 + 1 + 1 + 3)
    return cells * per_cell + points * per_point


def _padded(count: int) -> int:
    return -(-count // BLOCK) * BLOCK


def _extended(values: np.ndarray, filling: Any) -> np.ndarray:
    """Rows up to a multiple of the block; the added ones hold the filling."""
    pad = [(0, _padded(len(values)) - len(values))] + [(0, 0)] * (values.ndim - 1)
    return np.pad(values, pad, constant_values=filling)


def interleaved(table: np.ndarray, filling: Any) -> np.ndarray:
    """A table (R, W) as the kernels read it: W runs of a column for each block of rows, flat.

    Entry (r, w) is at `cell_kernel.entry(r, w, W)`.
    """
    blocks = _extended(table, filling).reshape(-1, BLOCK, table.shape[1])
    return blocks.transpose(0, 2, 1).ravel()


def _shifted(node_slots: np.ndarray, first_cell: int, nothing: int) -> np.ndarray:
    """Slots of a case whose first cell is not the first of the batch; `nothing` for none."""
    return np.where(node_slots == NO_SLOT, nothing, node_slots + 81 * first_cell)


def _cell_table(domain: Domain) -> np.ndarray:
    """Constants of the cells: shear and bulk modulus, one over the edge; shape (C, 3)."""
    return np.concatenate([domain.moduli_MPa, 1.0 / domain.edges_mm[:, None]], axis=1)


def _holds(domain: Domain) -> np.ndarray:
    """What holds each node: nothing, a wall, or its leaders; shape (N,)."""
    found = domain.fixed.astype(np.int64) * layout.FIXED
    found[domain.ties.nodes] = layout.TIED
    return found


def _shared_ties(domains: list[Domain], first_nodes: list[int]) -> Ties | None:
    """The ties of all cases, by follower and by leader."""
    everything = list(zip([d.ties for d in domains], first_nodes, strict=False))
    tied = _joined([t.nodes + first for t, first in everything])
    if not len(tied):
        return None
    followers = _joined([t.followers + first for t, first in everything])
    leaders = _joined([t.leaders + first for t, first in everything])
    shares = _joined([t.shares for t, _ in everything])
    by_leader = np.argsort(leaders, kind="stable")
    counts = _joined([np.diff(t.starts) for t, _ in everything])
    leading, led = np.unique(leaders, return_counts=True)
    apart = np.zeros(first_nodes[-1], bool)
    apart[tied] = apart[leading] = True
    return Ties(
        tied=integers(tied),
        leader_starts=integers(np.concatenate([[0], np.cumsum(counts)])),
        leaders=integers(leaders),
        leader_shares=floats(shares),
        apart=integers(apart),
        leading=integers(leading),
        follower_starts=integers(np.concatenate([[0], np.cumsum(led)])),
        followers=integers(followers[by_leader]),
        follower_shares=floats(shares[by_leader]),
    )


def _point_table(domain: Domain) -> np.ndarray:
    """Constants of the surface points as in `layout.POINT`, shape (P, 11)."""
    points = domain.points
    columns = (
        points.position_mm - domain.target_mm,
        points.axis,
        points.stiffness_N_mm[:, None],
        points.sideways[:, None],
        domain.point_local,
    )
    return np.concatenate(columns, axis=1)


def _points_per_cell(domain: Domain) -> np.ndarray:
    """Surface points of each cell, padding included, shape (C,)."""
    counts = np.zeros(_padded(len(domain.rows)), np.int64)
    counts[domain.owners] = np.diff(domain.owner_starts)
    return counts


def _owners(counts: np.ndarray) -> np.ndarray:
    """Cell of each surface point, from the points of each cell; -1 alone where there are none."""
    found = np.repeat(np.arange(len(counts)), counts)
    return found if len(found) else np.array([-1])


def _starts(counts: list[int]) -> list[int]:
    return [0, *itertools.accumulate(counts)]


def _joined(parts: list[np.ndarray]) -> np.ndarray:
    return np.concatenate([np.asarray(part).ravel() for part in parts])


def _shared_samples(cases: list[Case]) -> tuple[np.ndarray, list[int]]:
    """Samples of all objects, those that cases share once, and where each case's begin."""
    known: dict[int, int] = {}
    parts: list[np.ndarray] = []
    first: list[int] = []
    length = 0
    for case in cases:
        samples = case.collider.samples
        if id(samples) not in known:
            known[id(samples)] = length
            parts.append(samples)
            length += samples.size
        first.append(known[id(samples)])
    return _joined(parts), first


def floats(values: np.ndarray) -> Any:
    """A device array of single precision with these values."""
    return _device(values, ti.f32, np.float32)


def integers(values: np.ndarray) -> Any:
    """A device array of 32-bit integers with these values."""
    return _device(values, ti.i32, np.int32)


def _device(values: np.ndarray, kind: Any, host: type) -> Any:
    # Taichi has no empty arrays: an empty one is a single number that no kernel reads.
    flat = np.ascontiguousarray(values, dtype=host).ravel()
    array = ti.ndarray(kind, max(1, flat.size))
    array.from_numpy(flat if flat.size else np.zeros(1, host))
    return array
