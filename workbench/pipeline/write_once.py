"""Folders that are written once: whole under their name, or not there.

A folder is filled under the name `.part-<pid>@<host>-...`, each of its files synced, and then
renamed.
"""

from __future__ import annotations

import contextlib
import errno
import os
import shutil
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from workbench.core.base.errors import StoreError
from workbench.system.unfinished import fresh_name, prefix

META = "meta.json"
"""File that says what is in the folder; the last one that is written."""


@contextlib.contextmanager
def part_of(root: Path, stage: str) -> Iterator[Path]:
    """A folder to fill and `publish`; one that was not published is removed.

    Raises:
        StoreError: If the disk is full or read-only.
    """
    part: Path | None = None
    try:
        folder = root / stage
        folder.mkdir(parents=True, exist_ok=True)
        part = Path(tempfile.mkdtemp(dir=folder, prefix=prefix()))
        yield part
    except OSError as error:
        raise _disk_error(error, root) from error
    finally:
        if part is not None:
            shutil.rmtree(part, ignore_errors=True)


def write_file(path: Path, write: Any) -> None:
    """Write a file and wait until it is on the disk."""
    with path.open("wb") as file:
        write(file)
        file.flush()
        os.fsync(file.fileno())


def publish(part: Path, final: Path) -> None:
    """Give a finished folder its name; of two writers the first one wins."""
    try:
        _rename(part, final)
    except FileExistsError:
        # Contents are equal by construction, unless an interrupted removal left a husk.
        if not (final / META).exists():
            with contextlib.suppress(FileNotFoundError):
                discard(final)
            with contextlib.suppress(FileExistsError):
                _rename(part, final)


def discard(folder: Path) -> None:
    """Remove a result: one rename makes it absent, whatever interrupts the rest."""
    aside = folder.with_name(fresh_name())
    folder.rename(aside)
    shutil.rmtree(aside, ignore_errors=True)


def _rename(part: Path, final: Path) -> None:
    try:
        part.rename(final)
    except OSError as error:
        if error.errno not in (errno.ENOTEMPTY, errno.EEXIST):
            raise
        raise FileExistsError(str(final)) from error


def _disk_error(error: OSError, root: Path) -> StoreError:
    # NumPy tells of an array that was written in part without a number.
    if error.errno in (errno.ENOSPC, errno.EDQUOT, None):
        with contextlib.suppress(OSError):
            free_mb = shutil.disk_usage(root).free / 2**20
            return StoreError(
                f"the disk of {root} is full ({free_mb:.0f} MB free)",
                hint="free some space, or choose another folder with --project; "
                "finished results are kept",
                at="store",
            )
    return StoreError(
        f"cannot write to {root}: {error.strerror or error}",
        hint="check the folder's permissions, or choose another one with --project",
        at="store",
    )
