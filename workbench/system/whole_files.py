"""Files of a project that people may edit: read when small, written whole or not at all."""

from __future__ import annotations

import contextlib
import os
import tomllib
from pathlib import Path
from typing import Any

from workbench.core.base.errors import StoreError, shortened
from workbench.system.names import numbered
from workbench.system.unfinished import fresh_name

MAX_TOML_BYTES = 1_000_000
"""Of a design; what is larger is something else."""


def free_path(path: Path) -> Path:
    """The path, or the first of it with a number that is not taken."""
    if not path.exists():
        return path
    taken = {other.stem for other in path.parent.glob(f"*{path.suffix}")}
    return path.with_stem(numbered(path.stem, taken))


def kept_text(path: Path) -> str:
    """The text of a file of the project that people may have edited.

    Raises:
        OSError: If it cannot be read.
        ValueError: If it is larger than a design may be, or not UTF-8.
    """
    if path.stat().st_size > MAX_TOML_BYTES:
        raise ValueError(f"it is larger than {MAX_TOML_BYTES} bytes")
    return path.read_text(encoding="utf-8")


def toml_table(text: str) -> dict[str, Any]:
    """The tables of a TOML file.

    Raises:
        ValueError: If it is none: also where Python's own parser has another error, as for 4,000
            brackets or a number of 5,000 digits.
    """
    try:
        return tomllib.loads(text)
    except RecursionError:
        raise ValueError("its lists or tables are nested too deeply") from None
    except tomllib.TOMLDecodeError as error:
        # The parser repeats names whole, however long.
        raise ValueError(shortened(str(error))) from error
    except ValueError:
        # Python reads no whole number of more digits.
        raise ValueError("one of its numbers has thousands of digits") from None


def write_atomically(path: Path, content: bytes) -> None:
    """Replace a file so that a reader sees the old or the new one, never a part.

    Raises:
        StoreError: If the disk is full or read-only; the old file stays.
    """
    part = path.with_name(fresh_name())
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with part.open("xb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        part.replace(path)
    except OSError as error:
        with contextlib.suppress(OSError):
            part.unlink()
        raise StoreError(
            f"cannot write {path}: {error.strerror or error}",
            hint="free some space or choose a writable folder; the old file is kept",
            at=str(path),
        ) from error
