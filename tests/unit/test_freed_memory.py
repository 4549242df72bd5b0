"""Freed memory stays with a process while it computes, and only then."""

from __future__ import annotations

import resource
import sys
from pathlib import Path

import numpy as np
import pytest

from workbench.core.base import freed_memory
from workbench.core.base.freed_memory import freed_memory_kept

pytestmark = pytest.mark.skipif(not sys.platform.startswith("linux"), reason="of GNU's C library")
PAGES = 2000
"""Of an array that the library takes straight from the system."""
TIMES = 20


def faults() -> int:
    """Pages that were asked of the system while large arrays came and went."""
    before = resource.getrusage(resource.RUSAGE_SELF).ru_minflt
    for _ in range(TIMES):
        # Its size is never that of an array which NumPy keeps.
        np.zeros(PAGES * resource.getpagesize(), np.uint8)[:: resource.getpagesize()] += 1
        np.ones(PAGES * resource.getpagesize(), np.uint8)
    return resource.getrusage(resource.RUSAGE_SELF).ru_minflt - before


def resident_pages() -> int:
    return int(Path("/proc/self/statm").read_text().split()[1])


def test_pages_are_asked_for_once_while_it_is_kept() -> None:
    """Forty arrays in the room of the first; nested uses end with the outer one."""
    with freed_memory_kept():
        with freed_memory_kept():
            assert faults() < 6 * PAGES
        assert faults() < 2 * PAGES


def test_a_library_that_takes_no_larger_limit_gets_its_largest(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Before 2.35: a limit left at 128 KiB would make every large array a new one."""
    limits: dict[int, int] = {}

    class Old:
        def mallopt(self, name: int, value: int) -> int:
            if name == freed_memory._MMAP_THRESHOLD and value > 2**25:
                return 0
            limits[name] = value
            return 1

        def malloc_trim(self, pad: int) -> int:
            return pad

    monkeypatch.setattr(freed_memory, "_gnu_library", Old)
    with freed_memory_kept():
        assert limits[freed_memory._MMAP_THRESHOLD] == 2**25
        assert limits[freed_memory._TRIM_THRESHOLD] == freed_memory.KEPT_BYTES
    assert limits == freed_memory.USUAL


def test_memory_is_given_back_afterwards() -> None:
    """300 MB that were freed within are gone when it ends, an error included."""
    before = resident_pages()
    with pytest.raises(ZeroDivisionError), freed_memory_kept():
        np.ones(300_000_000, np.uint8)
        assert resident_pages() - before > 200_000_000 / resource.getpagesize()
        _ = 1 / 0
    assert resident_pages() - before < 60_000_000 / resource.getpagesize()
