"""Keeps freed memory in the process for as long as it computes.

The C library hands every large array back to the system when it is freed, and the system clears
each page that the next one asks for: of a press by finite elements, which makes a few hundred such
arrays at every step, a third of the time of the processor was that. Meanwhile the memory of this
process does not shrink; afterwards it does.

Where the C library is not GNU's nothing happens: its own habits stay.
"""

from __future__ import annotations

import contextlib
import ctypes
import sys
import threading
from collections.abc import Generator

_TRIM_THRESHOLD, _TOP_PAD, _MMAP_THRESHOLD = -1, -2, -3
"""Names of `mallopt`, in malloc.h."""
KEPT_BYTES = 2**31 - 1
"""Free memory at the end of the heap from which it is given back while the process computes."""
PAD_BYTES = 2**26
"""Asked for beyond what is needed each time the heap grows."""
LARGEST_BYTES = 2**25
"""Largest array that comes from the heap where the library takes no larger limit (before 2.35), and
afterwards: the library's own limit grows to it, but no more once any option was set, and the one it
begins with makes every array of 128 KiB a new one. See `mallopt(3)`."""
KEEPING = {_MMAP_THRESHOLD: KEPT_BYTES, _TRIM_THRESHOLD: KEPT_BYTES, _TOP_PAD: PAD_BYTES}
USUAL = {_MMAP_THRESHOLD: LARGEST_BYTES, _TRIM_THRESHOLD: 2 * LARGEST_BYTES, _TOP_PAD: 2**17}

_users: list[object] = []
_turn = threading.Lock()


@contextlib.contextmanager
def freed_memory_kept() -> Generator[None]:
    """Memory that is freed meanwhile stays with this process; may be nested.

    Threads share it: the first to enter begins, the last to leave ends.
    """
    user = object()
    with _turn:
        _users.append(user)
        if len(_users) == 1:
            _set(KEEPING)
    try:
        yield
    finally:
        with _turn:
            _users.remove(user)
            if not _users:
                _set(USUAL)
                _give_back()


def _set(options: dict[int, int]) -> None:
    library = _gnu_library()
    if library is None:
        return
    for name, value in options.items():
        if not library.mallopt(name, value) and name == _MMAP_THRESHOLD:
            library.mallopt(name, LARGEST_BYTES)


def _give_back() -> None:
    library = _gnu_library()
    if library is not None:
        library.malloc_trim(0)


def _gnu_library() -> ctypes.CDLL | None:
    """The C library of this process where it has both functions."""
    if not sys.platform.startswith("linux"):
        return None
    library = ctypes.CDLL(None)
    return library if hasattr(library, "mallopt") and hasattr(library, "malloc_trim") else None
