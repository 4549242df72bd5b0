"""The folder that a command writes into."""

from __future__ import annotations

import contextlib
from collections.abc import Container, Iterable
from pathlib import Path

from workbench.core.errors import DesignError, StoreError
from workbench.project import write_atomically


def prepare(out: Path) -> None:
    """Make the folder and check that it can be written, before anything is computed.

    The summary of an earlier run goes: a run that fails must not leave another one's.

    Raises:
        DesignError: If a file has that name.
        StoreError: If the folder cannot be made or written.
    """
    if out.exists() and not out.is_dir():
        raise DesignError(
            f"{out} is a file, the results need a folder", hint="name another folder", at="--out"
        )
    probe = out / ".probe"
    write_atomically(probe, b"")
    for stale in (probe, out / "summary.json"):
        try:
            stale.unlink(missing_ok=True)
        except OSError as error:
            raise StoreError(
                f"cannot remove {stale}: {error.strerror or error}",
                hint="remove it yourself, or name another folder",
                at="--out",
            ) from error


def remove_stale(folder: Path, patterns: Iterable[str], *, keep: Container[str]) -> None:
    """Remove files of an earlier run that this one does not replace.

    Args:
        patterns: As of `Path.glob`, relative to the folder.
        keep: Paths relative to the folder that stay.
    """
    for pattern in patterns:
        for path in folder.glob(pattern):
            if path.relative_to(folder).as_posix() not in keep:
                with contextlib.suppress(OSError):
                    path.unlink()
