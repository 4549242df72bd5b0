"""Sweeps of a project as TOML files, `sweeps/NAME.toml`: a design file with the table `sweep`.

Figures stand in the file, so that the plot outlives the results; images come from the store.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from workbench.core.base.errors import DesignError, shown
from workbench.project.design_toml import design_to_toml
from workbench.project.project import Project
from workbench.project.state import case_table, read_state
from workbench.system.trash import restore_file, trash_file
from workbench.system.whole_files import kept_text, toml_table, write_atomically
from workbench.variants.score_card import finite_figures
from workbench.variants.sweeps import MOST, Point, Status, Sweep

FOLDER = "sweeps"


def sweep_path(project: Project, name: str) -> Path:
    """File of a sweep.

    Raises:
        DesignError: If the name cannot be one.
    """
    return project.folder / FOLDER / project.design_path(name).name


def list_sweeps(project: Project) -> list[str]:
    """Names of all files of sweeps, the newest first."""
    files = (project.folder / FOLDER).glob("*.toml")
    return [path.stem for path in sorted(files, key=lambda p: -p.stat().st_mtime)]


def save_sweep(project: Project, sweep: Sweep) -> Path:
    """Write a sweep as it stands.

    Raises:
        StoreError: If the folder cannot be written.
    """
    path = sweep_path(project, sweep.name)
    project.keep_files(sweep.base.design)
    press = case_table(sweep.base.case, project)
    table = {"path": sweep.path, "parts": sweep.parts, "points": sweep.points}
    text = design_to_toml(sweep.base.design, press_case=press, sweep=table)
    write_atomically(path, text.encode())
    return path


def delete_sweep(project: Project, name: str) -> str:
    """Move a sweep to the trash, readable or not; returns its name there. Its results stay stored.

    Raises:
        DesignError: If there is none of that name.
        StoreError: If the folder cannot be written.
    """
    return trash_file(project.folder / FOLDER, name, what="sweep")


def restore_sweep(project: Project, kept: str) -> str:
    """Bring a sweep back from the trash; returns its name, which may have got a number.

    Raises:
        DesignError: If the trash does not hold it.
        StoreError: If the folder cannot be written.
    """
    return restore_file(project.folder / FOLDER, kept, what="sweep")


def load_sweep(project: Project, name: str) -> Sweep:
    """Read a sweep.

    Raises:
        DesignError: If the file is gone or was edited into nonsense.
    """
    path = sweep_path(project, name)
    try:
        text = kept_text(path)
        table: dict[str, Any] = toml_table(text)["sweep"]
        points = tuple(_point(row) for row in table["points"])
        if not 1 <= len(points) <= MOST:
            raise ValueError(f"it has {len(points)} points")
        field, parts = str(table["path"]), bool(table["parts"])
    except (OSError, ValueError, KeyError, AttributeError, TypeError) as error:
        what = f"it has no {error}" if isinstance(error, KeyError) else str(error)
        raise DesignError(
            f"sweep {shown(name)} cannot be read: {what}", hint=f"see {path}", at="sweep"
        ) from error
    base = read_state(text, project, source=str(path))
    sweep = Sweep(name=name, base=base, path=field, points=points, parts=parts)
    # A field that the family has not any more is told now, not in the middle of a run.
    _ = sweep.field
    return sweep


def _point(row: Mapping[str, Any]) -> Point:
    keys = {str(stage): str(key) for stage, key in row["keys"].items()}
    if not all(key.isalnum() for key in keys.values()):
        raise ValueError("a point has a key that is none")
    return Point(
        value=float(row["value"]),
        status=Status(row["status"]),
        message=str(row["message"]),
        figures=finite_figures({str(k): float(v) for k, v in row["figures"].items()}),
        keys=keys,
        seconds=float(row["seconds"]),
    )
