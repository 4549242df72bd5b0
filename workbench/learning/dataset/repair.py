"""Find samples that cannot be used, and drop them so that `make` computes them anew."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from pathlib import Path

from workbench.core.base.errors import StoreError
from workbench.learning.dataset.folder import FAILED, SAMPLES, DataSet
from workbench.learning.dataset.lock import held


def damaged(data: DataSet) -> Iterator[tuple[Path, str]]:
    """File and reason of each sample that cannot be used; reads all of them."""
    for case in data.all_cases:
        for frame in data.frames(case):
            try:
                data.sample(case, frame)
            except StoreError as error:
                yield data.path(case, frame), error.message


def repair(folder: Path) -> list[tuple[Path, str]]:
    """Drop damaged samples, and forget failures so that they are tried once more.

    Returns:
        File and reason of each sample that was dropped.

    Raises:
        StoreError: If it is no data set, a process is making it, or it cannot be written.
    """
    data = DataSet.open(folder)
    with held(folder):
        found = list(damaged(data))
        try:
            for path, _ in found:
                path.unlink()
            (folder / FAILED).unlink(missing_ok=True)
        except OSError as error:
            raise StoreError(
                f"cannot change {folder}: {error.strerror or error}",
                hint="check the permissions of the folder",
                at=str(folder),
            ) from error
        clear_parts(folder)
    return found


def clear_parts(folder: Path) -> None:
    """Remove what killed writers left behind; call it while holding the lock only."""
    for part in (*folder.glob(".part-*"), *(folder / SAMPLES).glob("*/.part-*")):
        with contextlib.suppress(OSError):
            part.unlink()
