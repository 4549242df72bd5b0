"""Saved variants: a design, the keys of its results and its numbers, one TOML file each."""

from __future__ import annotations

import dataclasses
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from workbench.core.errors import DesignError
from workbench.core.sensing import Shot
from workbench.map_display import scores
from workbench.project import Project, design_to_toml, write_atomically
from workbench.stages import Call
from workbench.state import State, case_table, read_state


@dataclass(frozen=True, kw_only=True, slots=True)
class Variant:
    """A design and its press as they were when they were kept."""

    name: str
    state: State
    shoot_key: str
    metrics: Mapping[str, float]


def save_variant(project: Project, name: str, state: State, calls: dict[str, Call]) -> Path:
    """Keep a design and its press, whose results are stored, with the maps' scores if there are.

    Raises:
        DesignError: If the name cannot be a file name.
        StoreError: If the results are missing or the folder cannot be written.
    """
    shot: Shot = project.store.load("shoot", calls["shoot"].key)
    metrics = {
        "press_depth_mm": state.case.press.depth_mm,
        **shot.metrics.values,
    }
    maps = calls.get("maps")
    if maps is not None and project.store.has("maps", maps.key):
        metrics |= scores(project.store.load("maps", maps.key))
    table = {"name": name, "shoot_key": calls["shoot"].key, "metrics": metrics}
    press_case = case_table(state.case, project)
    named = dataclasses.replace(state.design, name=name)
    project.keep_files(named)
    text = design_to_toml(named, press_case=press_case, variant=table)
    path = _folder(project) / project.design_path(name).name
    write_atomically(path, text.encode())
    return path


def list_variants(project: Project) -> list[str]:
    """Names of all kept variants."""
    return sorted(path.stem for path in _folder(project).glob("*.toml"))


def load_variant(project: Project, name: str) -> Variant:
    """Read a kept variant.

    Raises:
        DesignError: If the file is gone or was edited into nonsense.
    """
    path = _folder(project) / project.design_path(name).name
    try:
        text = path.read_text(encoding="utf-8")
        table: dict[str, Any] = tomllib.loads(text).pop("variant")
        metrics = {str(k): float(v) for k, v in table["metrics"].items()}
        key = str(table["shoot_key"])
    except (OSError, ValueError, KeyError, AttributeError, TypeError) as error:
        raise DesignError(
            f"variant {name!r} cannot be read: {error}", hint=f"see {path}", at="name"
        ) from error
    return Variant(
        name=name,
        state=read_state(text, project, source=str(path)),
        shoot_key=key,
        metrics=metrics,
    )


def _folder(project: Project) -> Path:
    return project.folder / "variants"
