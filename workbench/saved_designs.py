"""Designs that a designer has named and kept: one readable TOML each, with the press beside it.

They stand in the project's folder `designs/`; the version before the last save is kept in
`designs/previous/`, a deleted one in `designs/trash/`. A file that was edited into nonsense is
listed with its reason and never overwritten without being kept.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from workbench.core.errors import DesignError, StoreError, WorkbenchError
from workbench.project import AUTOSAVE, Project, design_to_toml, write_atomically
from workbench.state import State, case_table, read_state

PREVIOUS, TRASH = "previous", "trash"


@dataclass(frozen=True, kw_only=True, slots=True)
class SavedDesign:
    """One file of the list."""

    name: str
    family: str
    """Empty where the file cannot be read."""
    reason: str = ""
    """Why it cannot be read."""


def saved_names(project: Project) -> tuple[str, ...]:
    """Names of all kept designs, readable or not."""
    found = (path.stem for path in _folder(project).glob("*.toml"))
    return tuple(sorted(name for name in found if name != AUTOSAVE))


def saved_designs(project: Project) -> tuple[SavedDesign, ...]:
    """All kept designs, those that cannot be read with the reason."""
    return tuple(_listed(project, name) for name in saved_names(project))


def _listed(project: Project, name: str) -> SavedDesign:
    try:
        state = open_design(project, name)
    except WorkbenchError as error:
        return SavedDesign(name=name, family="", reason=error.message)
    return SavedDesign(name=name, family=state.design.family)


def save_named(project: Project, state: State) -> Path:
    """Keep a design and its press under the design's name; the version before is kept too.

    Raises:
        DesignError: If the name cannot be one of a file.
        StoreError: If the folder cannot be written; the old file stays.
    """
    name = state.design.name
    path = project.design_path(name)
    if name == AUTOSAVE:
        raise DesignError(
            f"{name!r} is what the workbench calls its own copy", hint="choose another", at="name"
        )
    if path.exists():
        write_atomically(path.parent / PREVIOUS / path.name, _bytes(path))
    project.keep_files(state.design)
    text = design_to_toml(state.design, press_case=case_table(state.case, project))
    write_atomically(path, text.encode())
    return path


def open_design(project: Project, name: str) -> State:
    """A kept design and its press.

    Raises:
        DesignError: If it is gone or was edited into nonsense.
    """
    path = project.design_path(name)
    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise DesignError(f"{path.name} cannot be read: {error}", hint=f"see {path}") from error
    return read_state(text, project, source=path.name)


def delete_design(project: Project, name: str) -> Path:
    """Move a kept design to the trash; returns where it is.

    Raises:
        DesignError: If there is none of that name.
        StoreError: If the folder cannot be written.
    """
    path = project.design_path(name)
    kept = path.parent / TRASH / path.name
    write_atomically(kept, _bytes(path))
    try:
        path.unlink()
    except OSError as error:
        raise StoreError(f"cannot remove {path}: {error}", hint="is it read-only?") from error
    return kept


def free_name(project: Project, name: str) -> str:
    """A name like this one that no kept design has: `finger 2` after `finger`."""
    stem, _, last = name.rpartition(" ")
    stem = stem if last.isdigit() and stem else name
    taken, number = set(saved_names(project)), 2
    while f"{stem} {number}" in taken:
        number += 1
    return f"{stem} {number}"


def _bytes(path: Path) -> bytes:
    try:
        return path.read_bytes()
    except OSError as error:
        raise DesignError(
            f"there is no readable design {path.stem!r}: {error}", hint="choose another", at="name"
        ) from error


def _folder(project: Project) -> Path:
    return project.folder / "designs"
