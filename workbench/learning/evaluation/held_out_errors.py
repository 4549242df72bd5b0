"""Measures the errors that advice is composed from: the record `ERRORS` of `pipeline.advice`.

`python -m workbench.learning.evaluation.held_out_errors [JOBS]` takes 10 minutes of one core.
Network and contact solver are scored on the held-out set that ships, coarse finite elements on some
of its presses, solved anew; all against the finite elements of the set. Finite elements themselves
are scored against converged limits, of which there are total forces only (`fem_errors`).
"""

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence
from concurrent.futures import Future, ProcessPoolExecutor
from multiprocessing import get_context
from typing import Any

import numpy as np

from sim.forces.contact_kind import ContactKind, kind_of_contact
from sim.forces.network.spec import Target
from sim.forces.network.weights import load_weights
from sim.forces.scores import ratio, summary
from workbench.core.press.fem import DRAFT_MM, QUALITY_MM
from workbench.core.press.indenter import Indenter
from workbench.learning.dataset.cases import Split
from workbench.learning.evaluation.coarse_presses import COARSE, coarse_scores, indenter_of
from workbench.learning.evaluation.evaluate import Named, evaluate_field
from workbench.learning.evaluation.scoring import Scored, Way
from workbench.learning.evaluation.sources import open_source
from workbench.pipeline import shipped
from workbench.pipeline.advice import ERRORS, ForceSource, Measured, row_table
from workbench.proof.validation.fem.fem_errors import (
    COUNT,
    Beside,
    beside_limit,
    expect_fresh_limits,
)

DATA = shipped.FOLDER / "heldout.npz"
EVERY = 7
"""Of the held-out presses, that are solved by coarse finite elements."""
MESHES = {ForceSource.DRAFT: DRAFT_MM, ForceSource.QUALITY: QUALITY_MM}
LIMITS = "converged limits"


def figures(jobs: int = 1) -> dict[str, Any]:
    """All rows, and what they are of.

    Args:
        jobs: Processes that solve presses.

    Raises:
        StoreError: If the limits are not those of today's code, or the held-out set is damaged.
    """
    expect_fresh_limits()
    source, path = open_source(DATA), shipped.shipped_weights(Target.FORCE)
    recipe = source.manifest["recipe"]
    with ProcessPoolExecutor(max_workers=jobs, mp_context=get_context("spawn")) as pool:
        limited = {
            which: [pool.submit(beside_limit, number, hex_mm) for number in range(COUNT)]
            for which, hex_mm in MESHES.items()
        }
        names = [case.id for case in source.cases()][::EVERY]
        solved = [pool.submit(coarse_scores, DATA, name) for name in names]
        named = Named(name=path.name, weights=load_weights(path))
        samples = evaluate_field(source, named, name=DATA.name).samples
        coarse = [scored for one in solved for scored in one.result()]
        rows = [
            *_rows(ForceSource.LEARNED, Way.LEARNED, samples, recipe),
            *_rows(ForceSource.MPM, Way.MPM, samples, recipe),
            *_rows(ForceSource.DRAFT, COARSE, coarse, recipe),
            *(row for which, found in limited.items() for row in _limited(which, found)),
        ]
    return {
        "network": path.name,
        "grid_mm": recipe["grid_mm"],
        "place": f"a {recipe['design']['family']}",
        "data": source.key,
        "rows": [row_table(row) for row in rows],
    }


def _rows(
    source: ForceSource, way: str, samples: Sequence[Scored], recipe: dict[str, Any]
) -> Iterator[Measured]:
    """A row for each kind of contact, of networks apart for objects that they know."""
    groups: dict[tuple[ContactKind, bool | None], list[Scored]] = {}
    for sample in samples:
        kind = kind_of_contact(indenter_of(sample.case, recipe), sheared=sample.sheared)
        seen = sample.case.split is not Split.UNSEEN if source is ForceSource.LEARNED else None
        if kind is not None:
            groups.setdefault((kind, seen), []).append(sample)
    for (kind, seen), members in groups.items():
        scores = [sample.scores[way] for sample in members]
        found, zero = summary(scores), summary([sample.scores[Way.ZERO] for sample in members])
        off_N = sum(np.linalg.norm(one.found_total - one.true_total) for one in scores)
        size_N = sum(np.linalg.norm(one.true_total) for one in scores)
        yield Measured(
            source=source,
            kind=kind,
            seen=seen,
            presses=len({sample.case.id for sample in members}),
            field=round(ratio(found.mae, zero.mae), 4),
            total=round(float(off_N / size_N), 4),
            peak_bias=round(found.peak_pressure_bias, 4),
            against=f"finite elements of {recipe['hex_mm']:g} mm",
        )


def _limited(source: ForceSource, solved: Sequence[Future[Beside]]) -> Iterator[Measured]:
    """Total forces of finite elements beside those that they should tend to."""
    groups: dict[ContactKind, list[np.ndarray]] = {}
    for one in solved:
        thing, pairs = one.result()
        kind = kind_of_contact(Indenter(kind=thing), sheared=False)
        if kind is not None:
            groups.setdefault(kind, []).append(np.array(pairs))
    for kind, found in groups.items():
        forces_N = np.concatenate(found)
        off_N = np.abs(forces_N[:, 0] - forces_N[:, 1]).sum()
        yield Measured(
            source=source,
            kind=kind,
            seen=None,
            presses=len(found),
            total=round(float(off_N / forces_N[:, 1].sum()), 4),
            against=LIMITS,
        )


def main(words: Sequence[str]) -> int:
    """Measure and keep them."""
    jobs = int(words[0]) if words else 1
    ERRORS.make(lambda: figures(jobs))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
