"""Files that were deleted: moved into `trash/` beside the others, under names of their own.

Nothing in it is ever overwritten: where a name is taken, the later file gets a number, and so does
one that comes back to where another has its name by now. A file may have a thumbnail beside it.
"""

from __future__ import annotations

from pathlib import Path

from workbench.core.base.errors import DesignError, StoreError, shown
from workbench.system.names import numbered

TRASH = "trash"
ENDINGS = (".toml", ".png")
"""A file and its thumbnail."""


def trash_file(folder: Path, name: str, *, what: str) -> str:
    """Move a file into the trash of its folder, readable or not; returns its name there.

    Args:
        folder: Where it lies.
        name: Its name, without the ending.
        what: What such a file is, for messages.

    Raises:
        DesignError: If there is none of that name.
        StoreError: If the folder cannot be written.
    """
    if name not in file_names(folder):
        raise DesignError(f"there is no {what} {shown(name)}", hint="it is gone already", at=what)
    return _move(folder, folder / TRASH, name)


def restore_file(folder: Path, kept: str, *, what: str) -> str:
    """Bring a file back from the trash; returns its name, which may have got a number.

    Raises:
        DesignError: If the trash does not hold it.
        StoreError: If the folder cannot be written.
    """
    if kept not in file_names(folder / TRASH):
        hint = f"look in {folder / TRASH}"
        raise DesignError(f"the trash has no {what} {shown(kept)}", hint=hint, at=what)
    return _move(folder / TRASH, folder, kept)


def file_names(folder: Path) -> list[str]:
    """Names of the files of a folder, without their ending, sorted."""
    return sorted(path.stem for path in folder.glob("*.toml"))


def move_file(source: Path, target: Path) -> None:
    """Move a file, if it is there; its folder is made.

    Raises:
        StoreError: If a folder cannot be written.
    """
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        if source.is_file():
            source.replace(target)
    except OSError as error:
        raise StoreError(
            f"cannot move {source} to {target}: {error.strerror or error}",
            hint="make the project folder writable; the file is where it was",
            at=str(source),
        ) from error


def _move(source: Path, target: Path, name: str) -> str:
    taken = file_names(target)
    free = name if name not in taken else numbered(name, taken)
    for ending in ENDINGS:
        move_file(source / f"{name}{ending}", target / f"{free}{ending}")
    return free
