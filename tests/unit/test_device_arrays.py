"""Arrays on the compute device are given back once nothing refers to them."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from sim.optics.light.device_arrays import on_device

ARRAY = np.ones((500_000, 3), dtype=np.float32)
TIMES = 40


def resident_mb() -> float:
    """Memory in use of this process [MB]."""
    found = re.search(r"VmRSS:\s+(\d+) kB", Path("/proc/self/status").read_text())
    assert found is not None
    return int(found[1]) / 1024.0


@pytest.mark.skipif(not Path("/proc/self/status").exists(), reason="reads Linux's own figures")
@pytest.mark.parametrize("vector", [0, 3])
def test_an_array_is_given_back(taichi_device: str, vector: int) -> None:
    """40 arrays of 6 MB, one after the other, take less than 5 of them at once."""
    on_device(ARRAY, vector=vector)
    before = resident_mb()
    for _ in range(TIMES):
        on_device(ARRAY, vector=vector)
    assert resident_mb() - before < 5 * ARRAY.nbytes / 1e6
