"""Makes networks such as ship, from nothing: presses, training, held-out sets.

`python -m workbench.learning.evaluation.shipped_networks FOLDER [JOBS]` makes the data sets below
in the folder, trains both networks on them and writes weights and held-out sets over those that
ship; what was made already is kept. The finite elements take most of it: 7 to 35 paths an hour of
one core, by solver and by how many share the memory. `held_out_errors` is to be measured anew
afterwards.
"""

from __future__ import annotations

import dataclasses
import shutil
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from sim.forces.network.spec import Target
from sim.forces.training.settings import PRESETS
from workbench.core.objects.kind import Group, kinds
from workbench.core.press.indenter import SEEN, UNSEEN, IndenterKind
from workbench.learning.dataset.folder import DataSet
from workbench.learning.dataset.positions import Pattern
from workbench.learning.dataset.recipe import Recipe
from workbench.learning.dataset.variation import Vary
from workbench.learning.evaluation.packing import made_from
from workbench.learning.evaluation.sources import states
from workbench.learning.making.collect import make
from workbench.learning.training.learn import train
from workbench.learning.training.plan import Plan, Resources
from workbench.learning.training.reading import read_presses
from workbench.pipeline import shipped
from workbench.project.named_designs import load_design
from workbench.project.project import Project

PRESET = "small"
TARGETS = (Target.FORCE, Target.DISPLACEMENT)
MOST_BYTES = 820_000
"""Of a held-out set."""
ALSO = tuple(
    IndenterKind(name)
    for name, kind in kinds().items()
    if kind.group is Group.OTHER and not kind.of_triangles
)
"""Objects that the paper does not have."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Part:
    """Data sets of one recipe, on several membranes."""

    cases: dict[str, int]
    """How many by membrane."""
    changes: dict[str, Any]
    """What its recipe has of its own."""
    held_out: bool = False
    """Whether nothing of it is trained on."""


PARTS = {
    "1": Part(cases={"geltip": 19, "pad": 10, "trunk": 12, "paw": 14}, changes={"seed": 0}),
    "2": Part(
        cases={"geltip": 21, "pad": 10, "trunk": 11, "paw": 10},
        changes={"seed": 2, "indenters": SEEN, "shares": (8, 1, 1)},
    ),
    "3": Part(
        cases={"geltip": 18, "pad": 7, "trunk": 8, "paw": 15},
        changes={"seed": 5, "indenters": (*ALSO, *SEEN), "shares": (1, 0, 0)},
    ),
    "4": Part(
        cases={"geltip": 4, "pad": 4, "trunk": 4, "paw": 4},
        changes={"seed": 3, "indenters": UNSEEN},
        held_out=True,
    ),
}


def recipe_of(membrane: str, part: Part) -> Recipe:
    """Presses 1 mm deep all over a membrane, sheared by .5 mm, objects of 3 to 12 mm, turned."""
    recipe = Recipe(
        design=load_design(membrane),
        pattern=Pattern.SPREAD,
        points=240,
        depth_step_mm=0.2,
        images=False,
        vary=Vary(size_mm=(3.0, 12.0), spin_deg=(-180.0, 180.0)),
        cases=part.cases[membrane],
    )
    return dataclasses.replace(recipe, **part.changes)


def data_sets(folder: Path, jobs: int) -> Iterator[tuple[str, str, DataSet]]:
    """Membrane, part and data set, each made as far as it is not there.

    Raises:
        StoreError: If the folder holds something else.
        LaneError: If a process ended by itself.
    """
    project = Project(folder / "project")
    for name, part in PARTS.items():
        for membrane in part.cases:
            place = folder / f"{membrane}-{name}"
            yield membrane, name, make(recipe_of(membrane, part), place, project, jobs=jobs)


def main(words: Sequence[str]) -> int:
    """Make them all."""
    from workbench.pipeline.devices import torch_device

    folder, jobs = Path(words[0]), int(words[1]) if len(words) > 1 else 1
    found = list(data_sets(folder, jobs))
    learned = [data.folder for _, name, data in found if not PARTS[name].held_out]
    fresh = []
    for target in TARGETS:
        plan = Plan(settings=PRESETS[PRESET], target=target)
        resources = Resources(device=torch_device())
        presses = read_presses(learned, targets=[target])
        fresh.append(train(presses, plan, folder / target.value, resources=resources).weights)
    held_out = shipped.FOLDER / shipped.HELD_OUT
    for old in [*shipped.FOLDER.glob("*.weights"), *held_out.glob("*.npz")]:
        old.unlink()
    for path in fresh:
        shutil.copy(path, shipped.FOLDER)
    for membrane, name, data in found:
        if states(data):
            packed = made_from(data, most_bytes=MOST_BYTES, name=membrane)
            (held_out / f"{membrane}-{name}.npz").write_bytes(packed)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
