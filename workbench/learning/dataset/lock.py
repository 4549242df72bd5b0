"""One process at a time makes a data set, or trains on one."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from pathlib import Path

from workbench.core.base.errors import StoreError
from workbench.system.lock_file import LockFile


@contextlib.contextmanager
def held(folder: Path, *, doing: str = "making the data set") -> Iterator[None]:
    """Hold the lock of a folder.

    Args:
        folder: Of the data set or the training; it is made if it is not there.
        doing: What its holder does there, for the message to others.

    Raises:
        StoreError: If another process holds it, or the folder cannot be written.
    """
    lock = LockFile(folder)
    try:
        holder = lock.take()
    except OSError as error:
        raise StoreError(
            f"cannot write to {folder}: {error.strerror or error}",
            hint="choose a folder that can be written",
            at=str(folder),
        ) from error
    if holder is not None:
        where = f" on {holder.host}" if holder.elsewhere else ""
        raise StoreError(
            f"process {holder.pid}{where} is {doing} {folder}",
            hint=f"wait for it or stop it; if there is no such process, delete {lock.path}",
            at=str(folder),
        )
    try:
        yield
    finally:
        lock.release()
