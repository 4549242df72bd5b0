"""Makes the record of other stiffnesses: networks tuned for half and for twice the modulus.

`python -m workbench.proof.validation.learned.stiffness_figures FOLDER [JOBS]` presses the first
cases of the first part of `shipped_networks` into fingers of such gel, tunes the networks that ship
on those for training, and scores them on the others; what lies in the folder already is kept. It
takes some 30 minutes of one core, nearly all of it finite elements.
"""

from __future__ import annotations

import dataclasses
import math
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from sim.forces.network.spec import Target
from sim.forces.network.weights import load_weights
from sim.forces.training.settings import PRESETS
from workbench.learning.dataset.folder import DataSet
from workbench.learning.evaluation.evaluate import Named
from workbench.learning.evaluation.scoring import Way
from workbench.learning.evaluation.shipped_networks import PARTS, recipe_of
from workbench.learning.evaluation.sources import Source, open_source
from workbench.learning.evaluation.stiffness import StiffnessResult, Tuning, evaluate_stiffness
from workbench.learning.making.collect import make
from workbench.learning.training.learn import train
from workbench.learning.training.plan import Plan, Resources
from workbench.learning.training.reading import read_presses
from workbench.pipeline import shipped
from workbench.pipeline.devices import torch_device
from workbench.project.project import Project
from workbench.proof.validation.learned.learned_stiffness import FACTORS, RECORD, WORDS

PART = "1"
CASES = 14
"""Of which 6 are for training, 2 for validation, 2 are at unseen places, 4 of unseen objects."""


def made(factor: float, folder: Path, jobs: int) -> DataSet:
    """The presses at a stiffness, made as far as they are not there.

    Raises:
        StoreError: If the folder holds something else.
    """
    recipe = recipe_of(shipped.FIRST, PARTS[PART])
    young_MPa = factor * recipe.design.material.young_MPa
    recipe = dataclasses.replace(
        recipe, design=recipe.design.replace("material.young_MPa", young_MPa), cases=CASES
    )
    project = Project(folder / "project")
    return make(recipe, folder / FACTORS[factor], project, jobs=jobs)


def tuned(target: Target, data: DataSet, folder: Path) -> Path:
    """The shipped weights of a field, tuned on the presses for training."""
    base = shipped.shipped_weights(target)
    plan = Plan(
        settings=PRESETS["tune"], target=target, base=load_weights(base), base_name=base.stem
    )
    presses = read_presses([data.folder], targets=[target])
    place = folder / f"{data.folder.name}-{target.value}"
    return train(presses, plan, place, resources=Resources(device=torch_device())).weights


def figures(folder: Path, jobs: int = 1) -> dict[str, Any]:
    """All of them, for JSON."""
    base = open_source(shipped.held_out_sets()[shipped.FIRST][0])
    found = []
    for factor in FACTORS:
        data = made(factor, folder, jobs)
        paths = [
            path
            for target in WORDS
            for path in (shipped.shipped_weights(target), tuned(target, data, folder))
        ]
        found += scored(data, paths, base, name=FACTORS[factor])
    return {"cases": CASES, "found": found}


def scored(data: Source, weights: Sequence[Path], base: Source, *, name: str) -> list[dict]:
    """Both fields of a stiffness, for JSON.

    Args:
        data: Presses at that stiffness.
        weights: Files of the networks that ship and of those tuned on the presses.
        base: Held-out presses at the nominal stiffness.
        name: Of the presses, for messages.
    """
    named = [Named(name=path.name, weights=load_weights(path)) for path in weights]
    return [_told(one) for one in evaluate_stiffness(data, named, base, name=name)]


def _told(found: StiffnessResult) -> dict[str, Any]:
    scores = found.found
    zero = scores.ways[Way.ZERO]
    return {
        "target": found.target.value,
        "young_MPa": found.young_MPa,
        "factor": found.factor,
        "samples": zero.samples,
        "cases": scores.cases,
        "zero_mae": zero.mae,
        "over_zero": {
            way.value: scores.error_ratio(way, Way.ZERO)
            for way in (*Tuning, Way.MPM)
            if way in scores.ways
        },
        "common": found.common,
        "truth_off": None if math.isnan(found.truth_off) else found.truth_off,
    }


def main(words: Sequence[str]) -> int:
    """Make the record."""
    jobs = int(words[1]) if len(words) > 1 else 1
    RECORD.make(lambda: figures(Path(words[0]), jobs))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
