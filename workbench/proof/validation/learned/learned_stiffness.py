"""Other stiffnesses (Fig. 8): tuned networks beside the untuned force times the ratio of E.

The figures are a record that `stiffness_figures` makes: the four tuned networks would be 7 MB
beside the 10 that ship, and the rows of the truth say why nobody misses them.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from sim.forces.network.spec import Target
from workbench.core.base.errors import StoreError
from workbench.learning.evaluation import published
from workbench.learning.evaluation.stiffness import Tuning
from workbench.pipeline import shipped
from workbench.proof.row import Row, failed, stated
from workbench.system.record import Record

RECORD = Record(
    path=Path(__file__).with_name("learned_stiffness.json"),
    command="python -m workbench.proof.validation.learned.stiffness_figures FOLDER",
    sources=("workbench.proof.validation.learned.stiffness_figures",),
    apart=(
        "sim.contact",
        "sim.fem",
        "sim.optics",
        "geometry",
        "workbench.learning.making",
        "workbench.pipeline",
        "workbench.planning",
        "workbench.project",
        "workbench.system",
        "workbench.view",
        "workbench.core.design",
        "workbench.proof.row",
        "workbench.proof.validation.learned.learned_stiffness",
    ),
    files=tuple(shipped.shipped_weights(target) for target in Target if shipped.is_shipped(target)),
)
"""Presses are data, as those of held-out sets are: solvers of another day do not make it stale,
other networks, another training or another score do."""
FACTORS = {0.5: "halved", 2.0: "doubled"}
WORDS = {Target.FORCE: "force", Target.DISPLACEMENT: "deformation"}
NEAR = 0.01


def rows(kept: Record = RECORD) -> list[Row]:
    """Rows for each field at half and at twice the stiffness, or failed ones."""
    try:
        found, why = kept.figures()["found"], "not on record"
    except StoreError as error:
        found, why = [], error.message
    rows = []
    for factor, target in itertools.product(FACTORS, WORDS):
        here = [
            one
            for one in found
            if one["target"] == target.value and abs(one["factor"] / factor - 1.0) < NEAR
        ]
        rows += [row for one in here for row in _rows(one, factor, kept)] or [
            failed(f"learned_stiffness_{WORDS[target]}", f"E {FACTORS[factor]}", unit="1", why=why)
        ]
    return rows


def _rows(found: dict[str, Any], factor: float, kept: Record) -> Iterator[Row]:
    target = Target(found["target"])
    of_force, field = target is Target.FORCE, WORDS[target]
    case = (
        f"E {FACTORS[factor]}, {found['young_MPa']:g} MPa, {found['samples']} samples of "
        f"{found['cases']} cases"
    )
    over_zero, scaled = found["over_zero"], found["over_zero"][Tuning.SCALED.value]
    if Tuning.TUNED.value in over_zero:
        yield stated(
            f"learned_stiffness_{field}",
            f"{case}: tuned decoder, error over that of zero; null: the untuned network "
            + ("times the ratio of E" if of_force else "as it is"),
            over_zero[Tuning.TUNED.value],
            unit="1",
            reference=published.TUNED_MAE[target] / found["zero_mae"],
            null=scaled,
            record=kept,
        )
    else:
        yield failed(f"learned_stiffness_{field}", case, unit="1", why="no tuned weights")
    if of_force:
        yield stated(
            "learned_stiffness_untuned",
            f"{case}: untuned network as it is, error over that of zero; null: times the ratio",
            over_zero[Tuning.UNTUNED.value],
            unit="1",
            null=scaled,
            record=kept,
        )
    if found["common"]:
        proportion = "times the ratio of E" if of_force else "as it is"
        yield stated(
            f"learned_stiffness_truth_{field}",
            f"{case}: {field} by finite elements there against the nominal one {proportion}, on "
            f"{found['common']} samples of both sets; null: as it is",
            found["truth_off"],
            unit="1",
            null=abs(1.0 - 1.0 / found["factor"]) if of_force else None,
            record=kept,
        )
