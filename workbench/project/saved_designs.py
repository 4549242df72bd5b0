"""Designs that a designer has named and kept: one readable TOML each, with the press beside it.

They stand in the project's folder `designs/`. What a save replaces is kept as a numbered version
in `designs/previous/NAME/`, a deleted one in `designs/trash/`. A file that was edited into nonsense
is listed with its reason and never overwritten without being kept.
"""

from __future__ import annotations

import contextlib
from dataclasses import dataclass, field
from pathlib import Path

from workbench.core.base.errors import DesignError, WorkbenchError, shown
from workbench.planning.plan import plan
from workbench.project.design_toml import design_to_toml
from workbench.project.project import Project
from workbench.project.state import State, case_table, read_state
from workbench.system.names import AUTOSAVE
from workbench.system.trash import file_names, restore_file, trash_file
from workbench.system.whole_files import kept_text, write_atomically

PREVIOUS = "previous"
MOST_VERSIONS = 20
"""Versions kept of each design; the oldest go."""
Stamp = tuple[int, int]
"""Time of the last change [ns] and size [bytes] of a file."""


@dataclass(frozen=True, kw_only=True, slots=True)
class SavedDesign:
    """One file of the list."""

    name: str
    family: str
    """Empty where the file cannot be read."""
    build: str = ""
    """Key of its body's result."""
    reason: str = ""
    """Why it cannot be read."""


@dataclass
class SavedShelf:
    """The kept designs of a project; files that did not change are read once."""

    project: Project
    _read: dict[str, tuple[Stamp, SavedDesign]] = field(default_factory=dict)

    def entries(self) -> tuple[SavedDesign, ...]:
        """All kept designs, those that cannot be read with the reason."""
        return tuple(self._entry(name) for name in saved_names(self.project))

    def _entry(self, name: str) -> SavedDesign:
        stamp = file_stamp(self.project, name)
        known = self._read.get(name)
        if stamp is None or known is None or known[0] != stamp:
            found = _listed(self.project, name)
            if stamp is not None:
                self._read[name] = (stamp, found)
            return found
        return known[1]


def saved_names(project: Project) -> tuple[str, ...]:
    """Names of all kept designs, readable or not."""
    return tuple(name for name in file_names(_folder(project)) if name != AUTOSAVE)


def file_stamp(project: Project, name: str) -> Stamp | None:
    """What tells one version of a kept design from another; None where there is none."""
    try:
        about = (_folder(project) / f"{name}.toml").stat()
    except (OSError, ValueError):
        return None
    return about.st_mtime_ns, about.st_size


def _listed(project: Project, name: str) -> SavedDesign:
    try:
        state = open_design(project, name)
        build = plan(state.design, state.case)["build"].key
    except WorkbenchError as error:
        return SavedDesign(name=name, family="", reason=error.message)
    return SavedDesign(name=name, family=state.design.family, build=build)


def save_named(project: Project, state: State) -> Path:
    """Keep a design and its press under the design's name; what this replaces is kept too.

    Raises:
        DesignError: If the name cannot be one of a file.
        StoreError: If the folder cannot be written; the old file stays.
    """
    name = state.design.name
    path = project.design_path(name)
    if name == AUTOSAVE:
        raise DesignError(
            f"{shown(name)} is what the workbench calls its own copy",
            hint="choose another",
            at="name",
        )
    project.keep_files(state.design)
    press = case_table(state.case, project)
    content = design_to_toml(state.design, press_case=press).encode()
    if path.exists():
        _keep_version(path, content)
    write_atomically(path, content)
    return path


def versions(project: Project, name: str) -> list[Path]:
    """Files of a design's earlier versions, the oldest first."""
    files = (_folder(project) / PREVIOUS / name).glob("*.toml")
    return sorted((file for file in files if file.stem.isdecimal()), key=lambda f: int(f.stem))


def _keep_version(path: Path, content: bytes) -> None:
    """Keep a file that is about to be replaced by another content, and forget the oldest."""
    old = _bytes(path)
    if old == content:
        return
    folder = path.parent / PREVIOUS / path.stem
    kept = sorted(int(file.stem) for file in folder.glob("*.toml") if file.stem.isdecimal())
    write_atomically(folder / f"{kept[-1] + 1 if kept else 1}.toml", old)
    for number in kept[: max(len(kept) + 1 - MOST_VERSIONS, 0)]:
        # A version too many does no harm.
        with contextlib.suppress(OSError):
            (folder / f"{number}.toml").unlink()


def open_design(project: Project, name: str) -> State:
    """A kept design and its press.

    Raises:
        DesignError: If it is gone, too large, or was edited into nonsense.
    """
    path = project.design_path(name)
    try:
        text = kept_text(path)
    except (OSError, ValueError) as error:
        raise DesignError(f"{path.name} cannot be read: {error}", hint=f"see {path}") from error
    return read_state(text, project, source=path.name)


def delete_design(project: Project, name: str) -> str:
    """Move a kept design to the trash, readable or not; returns its name there.

    Raises:
        DesignError: If there is none of that name.
        StoreError: If the folder cannot be written.
    """
    if name == AUTOSAVE:
        raise DesignError("the autosave is not deleted", hint="choose another", at="design")
    return trash_file(_folder(project), name, what="design")


def restore_design(project: Project, kept: str) -> str:
    """Bring a design back from the trash; returns its name, which may have got a number.

    Raises:
        DesignError: If the trash does not hold it.
        StoreError: If the folder cannot be written.
    """
    return restore_file(_folder(project), kept, what="design")


def _bytes(path: Path) -> bytes:
    try:
        return path.read_bytes()
    except OSError as error:
        raise DesignError(
            f"there is no readable design {shown(path.stem)}: {error}",
            hint="choose another",
            at="name",
        ) from error


def _folder(project: Project) -> Path:
    return project.folder / "designs"
