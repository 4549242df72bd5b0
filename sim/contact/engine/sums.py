"""What the forces of each case come to, summed on the device by one launch.

Rows are summed in chunks, chunks in groups and groups in cases, each in a fixed order and none
across two cases: what one case does cannot change a bit of another, and no thread adds more than a
few dozen numbers, which is what a GPU would wait for.
"""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
import taichi as ti

from sim.contact.engine import sum_kernels
from sim.contact.engine.bundles import Nodes, Surface

CHUNK = 32
"""Rows, or chunks, added by one thread; fixed, so that the order of sums is too."""
COLUMNS = 6
"""Sums of a row."""


class Sums:
    """Sums over the nodes and over the surface points of B cases."""

    def __init__(
        self, nodes: Nodes, surface: Surface, node_starts: list[int], point_starts: list[int]
    ) -> None:
        """Prepare them.

        Args:
            nodes: Of the batch.
            surface: Its surface points.
            node_starts: First node of each case, then their number, B + 1.
            point_starts: First surface point of each case likewise.
        """
        self._cases = len(node_starts) - 1
        of_nodes, of_points = _pieces(node_starts), _pieces(point_starts)
        chunks = [*of_nodes, *of_points]
        # A case without points has no chunk, and its sums are nothing.
        counts = [len(of_case) for of_case in chunks]
        groups = _pieces([0, *itertools.accumulate(counts)])
        ends = [0, *itertools.accumulate(len(of_case) for of_case in groups)]
        self._totals = _doubles(2 * self._cases)
        node_bounds, point_bounds = _bounds(of_nodes), _bounds(of_points)
        partial = _doubles(sum(counts))
        arrays = {
            "forces": nodes.forces,
            "powers": nodes.powers,
            "fixed": nodes.fixed,
            "node_bounds": node_bounds,
            "point_forces": surface.point_forces,
            "held": surface.held,
            "point_bounds": point_bounds,
            "partial": partial,
            "group_bounds": _bounds(groups),
            "groups": _doubles(ends[-1]),
            "case_bounds": _bounds([list(itertools.pairwise(ends))]),
            "totals": self._totals,
        }
        self._arguments = {**arrays, "first": sum(len(of_case) for of_case in of_nodes)}
        self._graph = _graph(arrays)

    def read(self) -> tuple[np.ndarray, np.ndarray]:
        """Six sums of nodes and of points of each case in the last substep, (B, 6) each."""
        self._graph.run(self._arguments)
        found = self._totals.to_numpy().reshape(2, self._cases, COLUMNS)
        return found[0], found[1]


def _graph(arrays: dict[str, Any]) -> Any:
    """The sums as a compute graph: launched one by one they would wait for Python."""
    known = {
        name: ti.graph.Arg(ti.graph.ArgKind.NDARRAY, name, array.dtype, ndim=1)
        for name, array in arrays.items()
    }
    known["first"] = ti.graph.Arg(ti.graph.ArgKind.SCALAR, "first", ti.i32)

    builder = ti.graph.GraphBuilder()

    def dispatch(kernel: Any, *names: str) -> None:
        builder.dispatch(kernel, *(known[name] for name in names))

    dispatch(sum_kernels.node_sums, "forces", "powers", "fixed", "node_bounds", "partial")
    dispatch(sum_kernels.surface_sums, "point_forces", "held", "point_bounds", "first", "partial")
    dispatch(sum_kernels.fold, "partial", "group_bounds", "groups")
    dispatch(sum_kernels.fold, "groups", "case_bounds", "totals")
    return builder.compile()


def _pieces(starts: list[int]) -> list[list[tuple[int, int]]]:
    """Chunks of the rows of each case, as first row and the one after the last."""
    return [
        list(itertools.pairwise([*range(first, last, CHUNK), last]))
        for first, last in itertools.pairwise(starts)
    ]


def _bounds(pieces: list[list[tuple[int, int]]]) -> Any:
    """Chunks as a device array; one without rows where there are none."""
    flat = np.array(list(itertools.chain(*pieces)) or [(0, 0)], dtype=np.int32).ravel()
    found = ti.ndarray(ti.i32, flat.size)
    found.from_numpy(flat)
    return found


def _doubles(rows: int) -> Any:
    found = ti.ndarray(ti.f64, COLUMNS * max(1, rows))
    found.fill(0.0)
    return found
