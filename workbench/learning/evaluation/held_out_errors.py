"""Measures the errors that advice is composed from: the record `ERRORS` of `pipeline.advice`.

`python -m workbench.learning.evaluation.held_out_errors [JOBS]` takes 10 minutes of one core.
Network and contact solver are scored on the held-out sets that ship, coarse finite elements on some
of the presses of the finger, solved anew; all against the finite elements of the sets. Finite
elements themselves are scored against converged limits, of which there are total forces only
(`fem_errors`).
"""

from __future__ import annotations

import itertools
import sys
from collections.abc import Iterator, Sequence
from concurrent.futures import Future, ProcessPoolExecutor
from dataclasses import dataclass
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np

from sim.forces.contact_kind import ContactKind, kind_of_contact
from sim.forces.network.spec import Target
from sim.forces.network.weights import load_weights
from sim.forces.scores import ratio, summary
from workbench.core.press.fem import DRAFT_MM, QUALITY_MM
from workbench.core.press.indenter import Indenter
from workbench.learning.dataset.cases import Split
from workbench.learning.dataset.recipe import Recipe
from workbench.learning.evaluation.coarse_presses import COARSE, coarse_scores, recipe_of
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

EVERY = 3
"""Of the held-out presses of the finger, that are solved by coarse finite elements."""
MESHES = {ForceSource.DRAFT: DRAFT_MM, ForceSource.QUALITY: QUALITY_MM}
LIMITS = "converged limits"


def figures(jobs: int = 1) -> dict[str, Any]:
    """All rows, and what they are of.

    Args:
        jobs: Processes that solve presses.

    Raises:
        StoreError: If the limits are not those of today's code, or a held-out set is damaged.
    """
    expect_fresh_limits()
    path, places = shipped.shipped_weights(Target.FORCE), shipped.held_out_sets()
    finger = places[shipped.FIRST]
    with ProcessPoolExecutor(max_workers=jobs, mp_context=get_context("spawn")) as pool:
        limited = {
            which: [pool.submit(beside_limit, number, hex_mm) for number in range(COUNT)]
            for which, hex_mm in MESHES.items()
        }
        wanted = [(data, case.id) for data in finger for case in open_source(data).cases()]
        solved = [(data, pool.submit(coarse_scores, data, name)) for data, name in wanted[::EVERY]]
        named = Named(name=path.name, weights=load_weights(path))
        found = [_Pressed.of(data, named) for data in itertools.chain(*places.values())]
        coarse = [_Pressed(recipe=_recipe(data), samples=one.result()) for data, one in solved]
        rows = [
            *_rows(ForceSource.LEARNED, Way.LEARNED, found),
            *_rows(ForceSource.MPM, Way.MPM, found),
            *_rows(ForceSource.DRAFT, COARSE, coarse),
            *(row for which, found in limited.items() for row in _limited(which, found)),
        ]
    families = dict.fromkeys(one.recipe.design.family for one in found)
    return {
        "network": path.name,
        "grid_mm": found[0].recipe.grid_mm,
        "place": f"a {' or '.join(families)}",
        "data": [one.recipe.key for one in found],
        "rows": [row_table(row) for row in rows],
    }


@dataclass(frozen=True, kw_only=True, slots=True)
class _Pressed:
    """Scored samples of one set."""

    recipe: Recipe
    samples: Sequence[Scored]

    @classmethod
    def of(cls, data: Path, named: Named) -> _Pressed:
        samples = evaluate_field(open_source(data), named, name=data.name).samples
        return cls(recipe=_recipe(data), samples=samples)


def _recipe(data: Path) -> Recipe:
    return recipe_of(open_source(data))


def _rows(source: ForceSource, way: str, sets: Sequence[_Pressed]) -> Iterator[Measured]:
    """A row for each kind of contact, of networks apart for objects that they know."""
    groups: dict[tuple[ContactKind, bool | None], list[Scored]] = {}
    pressed: dict[tuple[ContactKind, bool | None], set[tuple[str, str]]] = {}
    for recipe, sample in ((one.recipe, sample) for one in sets for sample in one.samples):
        indenter = recipe.indenter(sample.case.indenter, sample.case.drawn)
        kind = kind_of_contact(indenter, sheared=sample.sheared)
        seen = sample.case.split is not Split.UNSEEN if source is ForceSource.LEARNED else None
        if kind is not None:
            groups.setdefault((kind, seen), []).append(sample)
            # Sets of several membranes have cases of the same name.
            pressed.setdefault((kind, seen), set()).add((recipe.key, sample.case.id))
    for (kind, seen), members in groups.items():
        scores = [sample.scores[way] for sample in members]
        found, zero = summary(scores), summary([sample.scores[Way.ZERO] for sample in members])
        off_N = sum(np.linalg.norm(one.found_total - one.true_total) for one in scores)
        size_N = sum(np.linalg.norm(one.true_total) for one in scores)
        yield Measured(
            source=source,
            kind=kind,
            seen=seen,
            presses=len(pressed[kind, seen]),
            field=round(ratio(found.mae, zero.mae), 4),
            total=round(float(off_N / size_N), 4),
            peak_bias=round(found.peak_pressure_bias, 4),
            against=f"finite elements of {sets[0].recipe.hex_mm:g} mm",
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
