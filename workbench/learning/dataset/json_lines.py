"""Lines of JSON that are added to while a data set is made, and that survive a killed writer."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any

from workbench.core.base.errors import StoreError
from workbench.system.whole_files import write_atomically


def read_rows(path: Path) -> list[dict[str, Any]]:
    """Rows of a JSON-lines file; a last line that was cut off in writing is left out."""
    if not path.exists():
        return []
    *whole, _ = path.read_text(encoding="utf-8").split("\n")
    rows = []
    for line in whole:
        try:
            rows.append(json.loads(line))
        except ValueError as error:
            raise StoreError(
                f"{path} holds a line that is not JSON: {error}",
                hint=f"delete {path} and run again",
                at=str(path),
            ) from error
    return rows


def append_row(path: Path, row: dict[str, Any]) -> None:
    """Add a line to a JSON-lines file; a line cut off before is closed first.

    Raises:
        StoreError: If it cannot be written.
    """
    try:
        torn = path.exists() and path.read_bytes()[-1:] not in (b"", b"\n")
        if torn:
            whole = path.read_bytes().rpartition(b"\n")
            write_atomically(path, whole[0] + whole[1])
        with path.open("ab") as file:
            file.write(json.dumps(row).encode() + b"\n")
            file.flush()
            os.fsync(file.fileno())
    except OSError as error:
        raise StoreError(
            f"cannot write {path}: {error.strerror or error}",
            hint="free some space, then make it again; finished samples are kept",
            at=str(path),
        ) from error
