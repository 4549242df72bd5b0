"""Start a data set in an empty folder, or go on with the one that is there. It only ever grows."""

from __future__ import annotations

import dataclasses
import io
import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from workbench.core.base.errors import StoreError
from workbench.core.base.version import VERSION
from workbench.core.result.results import Skin
from workbench.learning.dataset.cases import Case, case_row
from workbench.learning.dataset.folder import (
    CASES,
    FORMAT,
    MANIFEST,
    SKIN,
    DataSet,
    mesh_key,
    skin_data,
)
from workbench.learning.dataset.recipe import Solvers, table_key
from workbench.planning.stage_table import STAGES
from workbench.system.lock_file import LOCK
from workbench.system.whole_files import write_atomically


def check_place(folder: Path, key: str) -> DataSet | None:
    """The data set of this recipe that is there, None where the folder is free.

    Raises:
        StoreError: If the folder holds something else.
    """
    if (folder / MANIFEST).exists():
        found = DataSet.open(folder)
        if found.key != key:
            raise StoreError(
                f"{folder} holds a data set of another recipe",
                hint="choose another folder, or give the options that it was begun with",
                at=str(folder),
            )
        return found
    ours = (LOCK, SKIN, CASES)
    if folder.exists() and any(p.name not in ours and p.name[0] != "." for p in folder.iterdir()):
        raise StoreError(
            f"{folder} is not empty and holds no data set",
            hint="choose a new or an empty folder",
            at=str(folder),
        )
    return None


def begin(
    folder: Path, recipe_table: Mapping[str, Any], skin: Skin, cases: Sequence[Case]
) -> DataSet:
    """Start a data set, or go on with the one that is there.

    Raises:
        StoreError: If the folder holds something else or what other versions of the solvers made,
            or cannot be written.
    """
    data, key = skin_data(skin), table_key(recipe_table)
    found = check_place(folder, key)
    if found is not None:
        if found.manifest["mesh"] != mesh_key(data):
            raise StoreError(
                f"the mesh of the data set {folder} is not the one that this program makes",
                hint=f"choose another folder; it was begun by version {found.manifest['program']}",
                at=str(folder),
            )
        _check_stages(found)
        if len(found.all_cases) > len(cases):
            cases = found.all_cases
    buffer = io.BytesIO()
    np.savez(buffer, **{f.name: getattr(data, f.name) for f in dataclasses.fields(data)})
    write_atomically(folder / SKIN, buffer.getvalue())
    rows = "".join(json.dumps(case_row(case)) + "\n" for case in cases)
    write_atomically(folder / CASES, rows.encode())
    manifest = {
        "format": FORMAT,
        "program": VERSION,
        "key": key,
        "recipe": dict(recipe_table),
        "stages": stage_versions(recipe_table),
        "mesh": mesh_key(data),
        "vertices": len(data.points_mm),
    }
    write_manifest(folder, {**manifest, "counts": {"cases": len(cases)}})
    return DataSet.open(folder)


def stage_versions(recipe_table: Mapping[str, Any]) -> dict[str, int]:
    """Version of each stage that a sample comes from: what they compute changed when one rises."""
    solvers = Solvers(recipe_table["solvers"])
    names = ["build", "mesh"]
    names += ["lattice", "press"] if solvers is not Solvers.FEM else []
    names += ["fem"] if solvers is not Solvers.MPM else []
    names += ["bake", "table", "shoot"] if recipe_table["images"] else []
    return {name: STAGES[name].version for name in names}


def _check_stages(found: DataSet) -> None:
    """Refuse to mix samples of two versions of a solver in one data set."""
    now, then = stage_versions(found.manifest["recipe"]), found.manifest["stages"]
    changed = [
        f"{name} {then.get(name)} then, {version} now"
        for name, version in now.items()
        if then.get(name) != version
    ]
    if changed:
        raise StoreError(
            f"the data set {found.folder} was begun with other versions of what computes it: "
            f"{', '.join(changed)}",
            hint="go on with the program that began it, or make it anew in another folder",
            at=str(found.folder),
        )


def write_manifest(folder: Path, manifest: Mapping[str, Any]) -> None:
    """Write the manifest, whole or not at all."""
    write_atomically(folder / MANIFEST, json.dumps(manifest, indent=1, allow_nan=False).encode())
