"""Learned forces: the shipped networks on what they never saw, and the network itself.

Frame rates are measured on the spot; the case says how many processes wanted to run meanwhile.
Those of a GPU come from a record (`workbench bench efficiency --record`).
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from workbench.pipeline.advice import ERRORS
from workbench.proof.row import Row, bounded

CONVOLUTION_POINTS = 1000
SPARSE_LIMITS = {"float32": 1e-6, "float64": 1e-12}


def rows(data: Path | None = None) -> list[Row]:
    """All rows of learned forces.

    Args:
        data: A data set, or a held-out set; None: those that ship.
    """
    from workbench.proof.validation.learned import (
        learned_precision,
        learned_scores,
        learned_speed,
        learned_stiffness,
    )

    found: list[Row] = []
    for target in learned_scores.WORDS:
        found += learned_scores.score_rows(target, data)
    found += learned_stiffness.rows()
    found.append(advice_row())
    found += sparse_rows()
    found += learned_precision.rows(data)
    return [*found, *learned_speed.rows()]


def advice_row() -> Row:
    """Whether what the browser advises rests on today's networks and code; null: no advice."""
    return bounded(
        "learned_advice",
        "errors by source and kind of contact that advice is composed from",
        lambda: float(len(ERRORS.figures()["rows"])),
        unit="1",
        limit=1.0,
        sense="min",
        null=0.0,
        record=ERRORS,
    )


def sparse_rows() -> list[Row]:
    """Sparse convolutions against dense ones; null: one that looks at no neighbour."""

    def difference(kind: str, *, own: bool = False) -> Callable[[], float]:
        def measure() -> float:
            from sim.forces.network.checks import sparse_dense_difference
            from workbench.proof.benchmarks.forces import shell

            points_mm = shell(CONVOLUTION_POINTS)
            return sparse_dense_difference(points_mm, double=kind == "float64", own_voxel_only=own)

        return measure

    return [
        bounded(
            "learned_sparse_equals_dense",
            f"{kind}: kernels of 5 and 3, gathered and as pairs, and steps of 2 on "
            f"{CONVOLUTION_POINTS} points, largest difference over the largest value",
            difference(kind),
            unit="1",
            limit=limit,
            null=difference(kind, own=True),
        )
        for kind, limit in SPARSE_LIMITS.items()
    ]
