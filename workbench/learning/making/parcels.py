"""Presses and their states on the way between processes, without the membrane that all share.

A press has some 8 MB, its states 6 MB: on a cluster they lie in files that all of it see, and their
paths are sent instead.
"""

from __future__ import annotations

import contextlib
import io
import pickle
import secrets
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from workbench.core.base.errors import StoreError

SHARED = "membrane"
Parcel = bytes | Path
"""What is packed, or the file that holds it."""


class _Packer(pickle.Pickler):
    def __init__(self, file: io.BytesIO, shared: object) -> None:
        super().__init__(file, protocol=pickle.HIGHEST_PROTOCOL)
        self._shared = shared

    def persistent_id(self, obj: Any, /) -> str | None:
        """A word in place of what is shared."""
        return SHARED if self._shared is not None and obj is self._shared else None


class _Unpacker(pickle.Unpickler):
    def __init__(self, file: io.BytesIO, shared: object) -> None:
        super().__init__(file)
        self._shared = shared

    def persistent_load(self, pid: Any, /) -> Any:
        """What is shared in place of the word."""
        return self._shared


def packed(value: Any, shared: object = None) -> bytes:
    """A value, with a word in place of the object that its reader has too."""
    buffer = io.BytesIO()
    _Packer(buffer, shared).dump(value)
    return buffer.getvalue()


def unpacked(parcel: Parcel, shared: object = None) -> Any:
    """The value; None in place of what was shared where the reader does not need it."""
    content = parcel.read_bytes() if isinstance(parcel, Path) else parcel
    return _Unpacker(io.BytesIO(content), shared).load()


def laid_down(parcel: Parcel, stem: Path) -> Path:
    """The same in a file of its own, whose name begins with `stem`.

    It is read once and need not outlive a crash, so nobody waits until the disk has it.

    Raises:
        StoreError: If the disk is full or read-only.
    """
    if isinstance(parcel, Path):
        return parcel
    path = stem.with_name(f"{stem.name}-{secrets.token_hex(8)}")
    try:
        path.write_bytes(parcel)
    except OSError as error:
        raise StoreError(
            f"cannot write {path}: {error.strerror or error}",
            hint="free some space: finished samples are kept, make it again",
            at=str(path.parent),
        ) from error
    return path


def drop(parcels: Iterable[Parcel]) -> None:
    """Remove the files of parcels that nobody will read again."""
    for parcel in parcels:
        if isinstance(parcel, Path):
            with contextlib.suppress(OSError):
                parcel.unlink()
