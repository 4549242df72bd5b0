"""Substeps launched without binding their arguments anew: what a small case waits for on a GPU."""

from __future__ import annotations

import inspect
from collections.abc import Iterable
from typing import Any

import taichi as ti

STEPS = 5
"""Substeps of a round: between two looks at the residual."""


class Launcher:
    """Substeps of a batch as a compute graph: its arguments are bound once, not at each launch.

    The arrays of all bundles go to the kernel's parameters of the same name.
    """

    def __init__(self, kernel: Any, bundles: Iterable[Any], *, cases: int) -> None:
        arrays = {name: a for bundle in bundles for name, a in bundle._asdict().items()}
        declared = {
            name: ti.graph.Arg(ti.graph.ArgKind.NDARRAY, name, array.dtype, ndim=1)
            for name, array in arrays.items()
        }
        declared["case_count"] = ti.graph.Arg(ti.graph.ArgKind.SCALAR, "case_count", ti.i32)
        steps = [
            ti.graph.Arg(ti.graph.ArgKind.SCALAR, f"step_{step}", ti.i32) for step in range(STEPS)
        ]
        names = inspect.signature(kernel).parameters
        self._graphs, self._arguments = {}, {}
        for count in (1, STEPS):
            builder = ti.graph.GraphBuilder()
            for step in steps[:count]:
                known = {**declared, "step": step}
                builder.dispatch(kernel, *(known[name] for name in names))
            self._graphs[count] = builder.compile()
            first = {f"step_{step}": step for step in range(count)}
            self._arguments[count] = {**arrays, "case_count": cases, **first}

    def run(self, count: int) -> None:
        """Run 1 or `STEPS` substeps, at the poses of the table's first rows."""
        self._graphs[count].run(self._arguments[count])
