"""From data sets, or files packed of them, to what training keeps; what does not belong is refused.

Several data sets are joined where nothing but the choice of presses, or the membrane, differs:
same material, spacing, versions of the solvers. A press in two of them counts once, and no pair of
object and place may be in two splits, or frames of one press would be learned from and tested on.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from sim.forces.network.spec import Target
from workbench.core.base.errors import DesignError, StoreError
from workbench.core.base.version import VERSION
from workbench.learning.dataset.cases import Case, Split
from workbench.learning.dataset.folder import DataSet
from workbench.learning.dataset.sample import Sample
from workbench.learning.training.packed import read_packed
from workbench.learning.training.presses import (
    INPUT,
    RAW,
    TRUTH,
    Presses,
    RestSkin,
    SparseField,
    State,
)

SAME = ("material", "hex_mm", "grid_mm")
"""Of a recipe or its design: what must not differ between data sets that are joined."""
MEMBRANE = ("family", "layers", "shape", "body", "meshing")
"""Of a design: what a skin is meshed from."""


def read_presses(
    places: Sequence[Path],
    *,
    targets: Sequence[Target] = tuple(Target),
    tick: Callable[[float], None] = lambda fraction: None,
) -> Presses:
    """Read data sets that belong together, or one packed file.

    Args:
        places: Folders of data sets, or a file written by `packed`.
        targets: What may be asked of it later; stress takes the most memory.
        tick: Told which fraction is read; may raise.

    Raises:
        StoreError: If a data set or a sample is damaged, of another format, or does not belong.
        DesignError: If a solver is missing, or a packed file and others are given together.
    """
    if any(place.is_file() for place in places):
        if len(places) > 1:
            raise DesignError(
                f"{len(places)} places of data with a packed file among them",
                hint="pack all data sets into one file, or name their folders",
                at="data",
            )
        return read_packed(places[0])
    sets = [DataSet.open(place) for place in places]
    _expect_alike(sets)
    reader = _Reader(_parts(targets))
    meshes = list(dict.fromkeys(data.manifest["mesh"] for data in sets))
    for number, data in enumerate(sets):
        skin = meshes.index(data.manifest["mesh"])
        reader.read(data, skin, lambda share, n=number: tick((n + share) / len(sets)))
    first = sets[0]
    return Presses(
        skins=tuple(_skin(sets, mesh) for mesh in meshes),
        states=tuple(reader.states),
        parts=reader.fields(),
        about={
            "sets": [str(data.folder.name) for data in sets],
            "keys": [data.key for data in sets],
            "recipes": [dict(data.manifest["recipe"]) for data in sets],
            "stages": dict(first.manifest["stages"]),
            "program": first.manifest["program"],
            "read_by": VERSION,
            "left_out": reader.left_out,
        },
    )


def _skin(sets: Sequence[DataSet], mesh: str) -> RestSkin:
    """The skin of the first data set that has this mesh."""
    data = next(one for one in sets if one.manifest["mesh"] == mesh)
    return RestSkin(
        points_mm=data.skin.points_mm,
        faces=data.skin.faces,
        mesh=mesh,
        design=dict(data.manifest["recipe"]["design"]),
    )


def _parts(targets: Sequence[Target]) -> list[str]:
    wanted = [INPUT, RAW[Target.FORCE]]
    for target in targets:
        wanted += [RAW.get(target, INPUT), TRUTH[target]]
    return list(dict.fromkeys(wanted))


def _expect_alike(sets: Sequence[DataSet]) -> None:
    first = sets[0]
    for data in sets[1:]:
        ours, theirs = first.manifest, data.manifest
        differs = [name for name in SAME if _part_of(ours, name) != _part_of(theirs, name)]
        alike = all(_part_of(ours, name) == _part_of(theirs, name) for name in MEMBRANE)
        if alike != (ours["mesh"] == theirs["mesh"]):
            differs.append("skin")
        differs += [
            f"version of {stage}"
            for stage, version in ours["stages"].items()
            if stage in theirs["stages"] and theirs["stages"][stage] != version
        ]
        if differs:
            raise StoreError(
                f"the data sets {first.folder} and {data.folder} do not belong together: they "
                f"differ in {', '.join(differs)}",
                hint="train on one of them, or make the other again with the same design and "
                "program",
                at=str(data.folder),
            )


def _part_of(manifest: Any, name: str) -> Any:
    recipe = manifest["recipe"]
    found = recipe["design"].get(name, recipe.get(name))
    # Where a number of a silicone comes from changes no press.
    return {k: v for k, v in found.items() if k != "source"} if name == "material" else found


class _Reader:
    """Collects the samples of data sets, sparse."""

    def __init__(self, parts: Sequence[str]) -> None:
        self.states: list[State] = []
        self.left_out: list[str] = []
        self._parts: dict[str, list[np.ndarray]] = {name: [] for name in parts}
        self._fields: dict[str, list[SparseField]] = {name: [] for name in parts}
        self._splits: dict[str, Split] = {}
        self._seen: set[tuple[str, int]] = set()

    def read(self, data: DataSet, skin: int, tick: Callable[[float], None]) -> None:
        """Read a data set of the skin of this number.

        Raises:
            StoreError: If a sample is damaged, or in another split than before.
            DesignError: If a solver is missing.
        """
        cases = data.cases()
        for number, case in enumerate(cases):
            tick(number / len(cases))
            self._expect_split(case, skin, data)
            for frame in data.frames(case):
                name = f"{_pair(case, skin)} {case.id}"
                if frame >= case.first_new and (name, frame) not in self._seen:
                    self._seen.add((name, frame))
                    self._take(case, skin, data.sample(case, frame), data)

    def _take(self, case: Case, skin: int, sample: Sample, data: DataSet) -> None:
        if sample.mpm is None or sample.fem is None:
            missing = "the contact solver" if sample.mpm is None else "finite elements"
            raise DesignError(
                f"the data set {data.folder} holds nothing by {missing}: a network learns from "
                "both",
                hint="make it with --solver both",
                at=str(data.folder),
            )
        state = State(
            # Data sets of two membranes name their cases alike.
            case=f"{skin}:{case.id}" if skin else case.id,
            frame=sample.frame,
            pair=_pair(case, skin),
            split=case.split,
            indenter=case.indenter.value,
            depth_mm=sample.depth_mm,
            skin=skin,
        )
        if not (sample.mpm.converged and sample.fem.converged):
            self.left_out.append(state.name)
            return
        self.states.append(state)
        for name, found in self._fields.items():
            solver, _, field = name.partition(".")
            dense = getattr(getattr(sample, solver), field)
            found.append(SparseField.of([dense], dense.shape[1]))

    def _expect_split(self, case: Case, skin: int, data: DataSet) -> None:
        known = self._splits.setdefault(_pair(case, skin), case.split)
        if known is not case.split:
            raise StoreError(
                f"{case.id} is for {case.split} in {data.folder} and for {known} in another data "
                "set: what is tested would have been learned",
                hint="make both with the same --seed",
                at=str(data.folder),
            )

    def fields(self) -> dict[str, SparseField]:
        """All that was read, one field for all states."""
        return {name: _joined(found) for name, found in self._fields.items()}


def _joined(fields: Sequence[SparseField]) -> SparseField:
    if not fields:
        return SparseField.of([], 3)
    sizes = [len(field.index) for field in fields]
    return SparseField(
        starts=np.concatenate([[0], np.cumsum(sizes)]).astype(np.int64),
        index=np.concatenate([field.index for field in fields]),
        values=np.concatenate([field.values for field in fields]),
    )


def _pair(case: Case, skin: int) -> str:
    """Object and place: positions of two seeds may share a name, but not a point."""
    place = ",".join(f"{x:.4f}" for x in case.position.target_mm)
    return f"{case.indenter.value}@{skin}:{place}"
