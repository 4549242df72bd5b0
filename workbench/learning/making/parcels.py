"""Presses and their states on the way between processes, without the membrane that all share."""

from __future__ import annotations

import io
import pickle
from typing import Any

SHARED = "membrane"


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


def unpacked(parcel: bytes, shared: object = None) -> Any:
    """The value; None in place of what was shared where the reader does not need it."""
    return _Unpacker(io.BytesIO(parcel), shared).load()
