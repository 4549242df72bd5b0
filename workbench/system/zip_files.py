"""What a zip archive that somebody else made holds, read so that it cannot grow beyond its limits.

The sizes that an archive declares are checked first, and not believed: members are read in pieces.
Only the two methods that every program writes are taken; the others unpack without a bound.
"""

from __future__ import annotations

import io
import struct
import zipfile
import zlib
from collections.abc import Callable

from workbench.core.base.errors import DesignError

METHODS = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)
PIECE_BYTES = 1 << 20
ENTRY = b"PK\x01\x02"
"""Begins each entry of an archive's list of members."""
MOST_LISTED = 1000
"""Entries that are counted before the list is read: one of a million takes seconds."""
BROKEN = (
    zipfile.BadZipFile,
    zlib.error,
    struct.error,
    EOFError,
    OSError,
    LookupError,
    ValueError,
    OverflowError,
    NotImplementedError,
    RuntimeError,
)
"""What Python raises for archives that are damaged, encrypted or made to confuse."""


def zip_members(
    name: str,
    content: bytes,
    *,
    wanted: Callable[[str], bool] = lambda member: True,
    most_files: int,
    most_bytes: int,
) -> dict[str, bytes]:
    """The wanted members of an archive by their paths in it.

    Args:
        name: Of the archive, for messages.
        content: The archive.
        wanted: Whether a member is read.
        most_files: Largest number of members.
        most_bytes: Largest size of all of them, unpacked.

    Raises:
        DesignError: If it is too large or cannot be read.
    """
    if content.count(ENTRY) > MOST_LISTED:
        raise _too_large(name, f"more than {MOST_LISTED} files", most_files, most_bytes)
    try:
        with zipfile.ZipFile(io.BytesIO(content)) as archive:
            members = archive.infolist()
            total = sum(member.file_size for member in members)
            if len(members) > most_files or total > most_bytes:
                size = f"{len(members)} files of {total / 1e6:.0f} MB"
                raise _too_large(name, size, most_files, most_bytes)
            return {m.filename: _read(archive, m) for m in members if wanted(m.filename)}
    except BROKEN as error:
        raise DesignError(
            f"{name} is not a zip that can be read: {error}", hint="save it again", at="design"
        ) from error


def _read(archive: zipfile.ZipFile, member: zipfile.ZipInfo) -> bytes:
    """A member's content, which must be as long as it declares."""
    if member.compress_type not in METHODS:
        raise zipfile.BadZipFile(f"{member.filename[:80]!r} is packed in another way than deflate")
    pieces, left = [], member.file_size + 1
    with archive.open(member) as file:
        while left > 0 and (piece := file.read(min(left, PIECE_BYTES))):
            pieces.append(piece)
            left -= len(piece)
    if left != 1:
        raise zipfile.BadZipFile(f"{member.filename[:80]!r} is not as long as it says")
    return b"".join(pieces)


def _too_large(name: str, size: str, most_files: int, most_bytes: int) -> DesignError:
    return DesignError(
        f"{name} unpacks to {size}, it may have at most {most_files} and {most_bytes / 1e6:.0f} MB",
        hint="is this a design saved by the workbench?",
        at="design",
    )
