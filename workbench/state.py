"""A design and its press as one thing: what a session, a variant and an autosave keep.

The press stands in the design's TOML as the table `press_case`. The mesh of an STL indenter is too
large for it: the project keeps it by its hash, so that a restart finds the same results.
"""

from __future__ import annotations

import dataclasses
import io
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from workbench.aim import default_target_mm
from workbench.core.design import SensorDesign
from workbench.core.digest import digest
from workbench.core.errors import DesignError
from workbench.core.indenter import Indenter, IndenterKind, IndenterMesh
from workbench.core.mapping import from_table, to_table
from workbench.core.press import ContactSettings, Press
from workbench.pipeline import PressCase
from workbench.project import Project, design_from_toml, parse_toml, write_atomically

PARTS = {"indenter": Indenter, "press": Press, "settings": ContactSettings}


@dataclass(frozen=True, kw_only=True, slots=True)
class State:
    """All that undo, a variant and a restart bring back."""

    design: SensorDesign
    case: PressCase


def fresh_state(design: SensorDesign, case: PressCase | None = None) -> State:
    """A design with a press (the default one) aimed where its family says."""
    case = PressCase() if case is None else case
    press = dataclasses.replace(case.press, target_mm=default_target_mm(design))
    return State(design=design, case=dataclasses.replace(case, press=press))


def case_table(case: PressCase, project: Project) -> dict[str, Any]:
    """A press as a table; the mesh of an STL indenter is written beside the designs.

    Raises:
        StoreError: If the mesh cannot be written.
    """
    table = to_table(dataclasses.replace(case, indenter=Indenter()))
    indenter = to_table(dataclasses.replace(case.indenter, kind=IndenterKind.SPHERE, mesh=None))
    mesh = case.indenter.mesh
    if mesh is not None:
        key = digest(mesh)
        path = _mesh_path(project, key)
        if not path.exists():
            buffer = io.BytesIO()
            np.savez_compressed(buffer, points_mm=mesh.points_mm, faces=mesh.faces)
            write_atomically(path, buffer.getvalue())
        indenter["mesh_key"] = key
    table["indenter"] = {**indenter, "kind": case.indenter.kind.value}
    return table


def read_state(text: str, project: Project, *, source: str) -> State:
    """A design and its press from a design file; a file without a press gets the default one.

    Raises:
        DesignError: If the text is not valid, or names an STL indenter this project does not have.
    """
    table = parse_toml(text, source=source).get("press_case", {})
    if not isinstance(table, Mapping):
        raise DesignError(
            f"press_case is {table!r}, expected a table", hint="remove it", at="press_case"
        )
    known = {
        name: from_table(kind, table[name], at=f"press_case.{name}")
        for name, kind in PARTS.items()
        if name in table and name != "indenter"
    }
    if "indenter" in table:
        known["indenter"] = _read_indenter(table["indenter"], project)
    design = design_from_toml(text, source=source, roots=(project.folder,))
    return State(design=design, case=PressCase(**known))


def _read_indenter(table: Any, project: Project) -> Indenter:
    at = "press_case.indenter"
    if not isinstance(table, Mapping) or "mesh_key" not in table:
        return from_table(Indenter, table, at=at)
    path = _mesh_path(project, str(table["mesh_key"]))
    try:
        with np.load(path) as arrays:
            mesh = IndenterMesh(points_mm=arrays["points_mm"], faces=arrays["faces"])
    except (OSError, KeyError, ValueError) as error:
        raise DesignError(
            f"the STL indenter of this press is not in the project: {error}",
            hint="load the STL file again",
            at=at,
        ) from error
    sizes = {name: table[name] for name in ("size_mm", "edge_radius_mm") if name in table}
    return dataclasses.replace(
        from_table(Indenter, sizes, at=at), kind=IndenterKind.MESH, mesh=mesh
    )


def _mesh_path(project: Project, key: str) -> Path:
    if not key.isalnum():
        raise DesignError(f"{key!r} is not the key of a mesh", hint="load the STL again", at="mesh")
    return project.folder / "indenters" / f"{key}.npz"
