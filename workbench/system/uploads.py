"""Files from the browser: refused when too large, else on disk for as long as they are read.

A file keeps the designer's name, which the messages of every reader tell, but never a folder of it:
what a page sends as a name is not to be trusted.
"""

from __future__ import annotations

import contextlib
import re
import tempfile
from collections.abc import Iterator
from pathlib import Path

from workbench.core.base.errors import DesignError

MOST_BYTES = 40_000_000
"""Larger files do not pass the browser's connection; the command line takes them."""
LONGEST_STEM, LONGEST_ENDING = 50, 10
"""Characters of a name; a file system takes 255 bytes, and a character may have four."""


@contextlib.contextmanager
def uploaded_file(
    name: str, content: bytes, *, limit_bytes: int, hint: str, at: str
) -> Iterator[Path]:
    """The path of an uploaded file, which is removed at the end.

    Args:
        name: As the browser sent it.
        content: Its bytes.
        limit_bytes: How many there may be.
        hint: What to do with a larger file.
        at: Field it is for.

    Raises:
        DesignError: If it is too large.
    """
    check_upload(name, content, limit_bytes=limit_bytes, hint=hint, at=at)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / own_name(name)
        path.write_bytes(content)
        yield path


def check_upload(name: str, content: bytes, *, limit_bytes: int, hint: str, at: str) -> None:
    """Refuse a file that is too large.

    Raises:
        DesignError: Naming its size and the limit.
    """
    if len(content) > limit_bytes:
        raise DesignError(
            f"{own_name(name)} has {len(content) / 1e6:.1f} MB, the browser takes "
            f"{limit_bytes / 1e6:g} MB",
            hint=hint,
            at=at,
        )


def own_name(name: str) -> str:
    """The last part of a name, of printable characters, short enough for every file system."""
    last = re.split(r"[/\\]", name)[-1]
    path = Path("".join(letter for letter in last if letter.isprintable()))
    if path.name in ("", ".", ".."):
        return "upload"
    return path.stem[:LONGEST_STEM] + path.suffix[:LONGEST_ENDING]
