"""One process at a time makes a data set, or trains on one: a lock file that names it.

A lock whose process has ended is taken over. Left out: processes of other machines, whose end
cannot be seen from here; their lock stands until somebody deletes it.
"""

from __future__ import annotations

import contextlib
import json
import os
import secrets
import socket
from collections.abc import Iterator
from pathlib import Path

from workbench.core.errors import StoreError
from workbench.processes import is_alive

LOCK = "lock"


@contextlib.contextmanager
def held(folder: Path, *, doing: str = "making the data set") -> Iterator[None]:
    """Hold the lock of a folder.

    Args:
        folder: Of the data set or the training; it is made if it is not there.
        doing: What its holder does there, for the message to others.

    Raises:
        StoreError: If another process holds it, or the folder cannot be written.
    """
    path = folder / LOCK
    own = json.dumps({"pid": os.getpid(), "host": socket.gethostname()}).encode()
    try:
        folder.mkdir(parents=True, exist_ok=True)
        while not _taken(path, own):
            _clear_dead(path, doing)
    except OSError as error:
        raise StoreError(
            f"cannot write to {folder}: {error.strerror or error}",
            hint="choose a folder that can be written",
            at=str(folder),
        ) from error
    try:
        yield
    finally:
        with contextlib.suppress(OSError):
            path.unlink()


def _taken(path: Path, own: bytes) -> bool:
    """Create the lock whole: a file with its content is linked to the name, unless it exists."""
    part = path.with_name(f".part-{os.getpid()}-{secrets.token_hex(6)}")
    part.write_bytes(own)
    try:
        os.link(part, path)
    except FileExistsError:
        return False
    finally:
        part.unlink()
    return True


def _clear_dead(path: Path, doing: str) -> None:
    """Remove the lock of a process that has ended; another's is put back where it was."""
    aside = path.with_name(f".part-{os.getpid()}-{secrets.token_hex(6)}")
    with contextlib.suppress(FileNotFoundError):
        _refuse_living(path, doing)
        path.rename(aside)
        # Between reading and renaming, somebody else may have taken over the dead lock.
        try:
            _refuse_living(aside, doing)
        except StoreError:
            aside.rename(path)
            raise
        aside.unlink()


def _refuse_living(path: Path, doing: str) -> None:
    try:
        holder = json.loads(path.read_bytes())
        pid, host = int(holder["pid"]), str(holder["host"])
    except (ValueError, KeyError, TypeError):
        return
    here = host == socket.gethostname()
    if here and not is_alive(pid):
        return
    where = "" if here else f" on {host}"
    raise StoreError(
        f"process {pid}{where} is {doing} {path.parent}",
        hint=f"wait for it or stop it; if there is no such process, delete {path.parent / LOCK}",
        at=str(path.parent),
    )
