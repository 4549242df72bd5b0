"""The files of all variants: listed, renamed, copied, moved to the trash and brought back.

A file that was edited into nonsense, or belongs to a newer version, is listed with its reason; it
can be deleted like any other.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from workbench.core.base.errors import WorkbenchError, shown
from workbench.project.project import Project
from workbench.system.names import numbered
from workbench.system.trash import file_names, move_file, restore_file, trash_file
from workbench.system.whole_files import write_atomically
from workbench.variants.variants import (
    Variant,
    folder,
    load_variant,
    planned_keys,
    refuse_taken,
    variant_path,
    write_variant,
)


@dataclass(frozen=True, kw_only=True, slots=True)
class Entry:
    """A file of the list: a variant, or why it cannot be read."""

    name: str
    variant: Variant | None
    reason: str = ""
    planned: Mapping[str, str] = field(default_factory=dict[str, str])
    """Keys that its results have now, by stage."""
    thumbnail: Path | None = None
    """PNG file of its thumbnail, if there is one."""


@dataclass
class Shelf:
    """The variants of a project; files that did not change are read and planned once."""

    project: Project
    _read: dict[str, tuple[tuple[int, int], Entry]] = field(default_factory=dict)

    def entries(self) -> list[Entry]:
        """All variants by name; those that cannot be read stand among them with the reason."""
        return [self._entry(path) for path in sorted(folder(self.project).glob("*.toml"))]

    def _entry(self, path: Path) -> Entry:
        try:
            about = path.stat()
            stamp = (about.st_mtime_ns, about.st_size)
        except OSError as error:
            return Entry(name=path.stem, variant=None, reason=error.strerror or str(error))
        known = self._read.get(path.stem)
        if known is None or known[0] != stamp:
            known = self._read[path.stem] = (stamp, _entry(self.project, path.stem))
        thumbnail = path.with_suffix(".png")
        return dataclasses.replace(known[1], thumbnail=thumbnail if thumbnail.is_file() else None)


def _entry(project: Project, name: str) -> Entry:
    try:
        variant = load_variant(project, name)
        return Entry(name=name, variant=variant, planned=planned_keys(variant.state))
    except WorkbenchError as error:
        # The list has the name before the reason.
        reason = error.message.removeprefix(f"variant {shown(name)} cannot be read: ")
        reason = reason.replace(repr(name), "its name", 1)
        return Entry(name=name, variant=None, reason=reason)


def list_variants(project: Project) -> list[str]:
    """Names of all files of variants, readable or not."""
    return file_names(folder(project))


def next_name(taken: Sequence[str]) -> str:
    """The first free name of variant A, B, ... Z, else one with a number."""
    letters = (f"variant {letter}" for letter in "ABCDEFGHIJKLMNOPQRSTUVWXYZ")
    free = next((name for name in letters if name not in taken), "")
    return free or numbered("variant", taken)


def rename_variant(project: Project, old: str, new: str) -> None:
    """Give a variant another name.

    Raises:
        DesignError: If the new name is taken or cannot be one, or the variant cannot be read.
        StoreError: If the folder cannot be written.
    """
    path, target = variant_path(project, old), variant_path(project, new)
    if old == new:
        return
    refuse_taken(target)
    _write_as(project, old, new)
    move_file(path.with_suffix(".png"), target.with_suffix(".png"))
    path.unlink(missing_ok=True)


def duplicate_variant(project: Project, name: str) -> str:
    """Copy a variant; returns the name of the copy.

    Raises:
        DesignError: If the variant cannot be read.
        StoreError: If the folder cannot be written.
    """
    copy = numbered(name, list_variants(project))
    _write_as(project, name, copy)
    thumbnail = variant_path(project, name).with_suffix(".png")
    if thumbnail.is_file():
        write_atomically(variant_path(project, copy).with_suffix(".png"), thumbnail.read_bytes())
    return copy


def _write_as(project: Project, name: str, other: str) -> None:
    variant = load_variant(project, name)
    design = dataclasses.replace(variant.state.design, name=other)
    state = dataclasses.replace(variant.state, design=design)
    write_variant(project, dataclasses.replace(variant, name=other, state=state))


def delete_variant(project: Project, name: str) -> str:
    """Move a variant to the trash, readable or not; returns its name there.

    Raises:
        DesignError: If there is none of that name.
        StoreError: If the folder cannot be written.
    """
    return trash_file(folder(project), name, what="variant")


def restore_variant(project: Project, kept: str) -> str:
    """Bring a variant back from the trash; returns its name, which may have got a number.

    Raises:
        DesignError: If the trash does not hold it.
        StoreError: If the folder cannot be written.
    """
    return restore_file(folder(project), kept, what="variant")
