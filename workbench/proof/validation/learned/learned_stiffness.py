"""Other stiffnesses (Fig. 8): tuned networks beside the untuned force times the ratio of E.

In the folder `stiffness` of the shipped weights lie held-out sets of other stiffnesses and the
networks that were tuned for them; without them the rows fail and say so.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from pathlib import Path

from sim.forces.network.spec import Target
from sim.forces.network.weights import SUFFIX, load_weights
from workbench.core.base.errors import StoreError, WorkbenchError
from workbench.learning.evaluation import published
from workbench.learning.evaluation.evaluate import Named
from workbench.learning.evaluation.scoring import Way
from workbench.learning.evaluation.sources import open_source
from workbench.learning.evaluation.stiffness import StiffnessResult, Tuning, evaluate_stiffness
from workbench.pipeline import shipped
from workbench.proof.row import Row, failed, stated

FOLDER = "stiffness"
FACTORS = {0.5: "halved", 2.0: "doubled"}
WORDS = {Target.FORCE: "force", Target.DISPLACEMENT: "deformation"}
NEAR = 0.01


def rows() -> list[Row]:
    """A row for each field at half and at twice the stiffness, or failed ones."""
    try:
        found = _evaluated(shipped.FOLDER / FOLDER)
    except WorkbenchError as error:
        found, why = [], error.message
    else:
        why = "no held-out set of this stiffness"
    rows = []
    for factor, target in itertools.product(FACTORS, WORDS):
        here = [
            one for one in found if one.target is target and abs(one.factor / factor - 1) < NEAR
        ]
        rows += [row for one in here for row in _rows(one, FACTORS[factor])] or [
            failed(f"learned_stiffness_{WORDS[target]}", f"E {FACTORS[factor]}", unit="1", why=why)
        ]
    return rows


def _evaluated(folder: Path) -> list[StiffnessResult]:
    sets = sorted(folder.glob("*.npz"))
    if not sets:
        raise StoreError(
            "no held-out set of another stiffness comes with this version",
            hint="make them with workbench dataset make --young MPa, then evaluate --pack",
            at=str(folder),
        )
    paths = [shipped.shipped_weights(target) for target in WORDS if shipped.is_shipped(target)]
    paths += sorted(folder.glob(f"*{SUFFIX}"))
    weights = [Named(name=path.name, weights=load_weights(path)) for path in paths]
    nominal = shipped.held_out_sets().get(shipped.FIRST)
    base = open_source(nominal[0]) if nominal else None
    return [
        one
        for path in sets
        for one in evaluate_stiffness(open_source(path), weights, base, name=path.name)
    ]


def _rows(found: StiffnessResult, words: str) -> Iterator[Row]:
    ways, field = found.found.ways, WORDS[found.target]
    samples = next(iter(ways.values())).samples
    case = f"E {words}, {found.young_MPa:g} MPa, {samples} samples of {found.found.cases} cases"
    zero, scaled = ways[Way.ZERO].mae, ways[Tuning.SCALED].mae
    if Tuning.TUNED in ways:
        yield stated(
            f"learned_stiffness_{field}",
            f"{case}: tuned decoder, error over that of zero; null: the untuned network "
            + ("times the ratio of E" if found.target is Target.FORCE else "as it is"),
            ways[Tuning.TUNED].mae / zero if zero else float("nan"),
            unit="1",
            reference=published.TUNED_MAE[found.target] / zero if zero else None,
            null=scaled / zero if zero else None,
        )
    else:
        yield failed(f"learned_stiffness_{field}", case, unit="1", why="no tuned weights")
    if found.target is Target.FORCE:
        yield stated(
            "learned_stiffness_untuned",
            f"{case}: untuned network as it is, error over that of zero; null: times the ratio",
            ways[Tuning.UNTUNED].mae / zero if zero else float("nan"),
            unit="1",
            null=scaled / zero if zero else None,
        )
    if found.common:
        proportion = "times the ratio of E" if found.target is Target.FORCE else "as it is"
        yield stated(
            f"learned_stiffness_truth_{field}",
            f"{case}: {field} by finite elements there against the nominal one {proportion}, on "
            f"{found.common} samples of both sets; null: as it is",
            found.truth_off,
            unit="1",
            null=abs(1.0 - 1.0 / found.factor) if found.target is Target.FORCE else None,
        )
