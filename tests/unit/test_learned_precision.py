"""How far fewer digits are from float32: the two measures, and what is read for them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from sim.forces.network.spec import SMALL
from workbench.pipeline import devices
from workbench.proof.validation.learned import learned_precision


def test_both_measures_of_a_difference() -> None:
    """Values 4, 0, -2 found as 4, 1, -3: the largest is 1 of 4, the sum 2 of 6."""
    found, expected = np.array([4.0, 1.0, -3.0]), np.array([4.0, 0.0, -2.0])
    assert learned_precision.apart(found, expected) == pytest.approx((0.25, 1 / 3))


def test_bfloat16_stays_near_float32_on_a_press_that_ships(monkeypatch: pytest.MonkeyPatch) -> None:
    """The small network, which is fast: neither equal nor beyond the limit."""
    monkeypatch.setattr(learned_precision, "NETWORK", SMALL.name)
    monkeypatch.setattr(devices, "torch_device", lambda: "cpu")
    largest, mean = learned_precision.rows()
    assert largest.ok and mean.ok and mean.limit is None
    assert largest.value is not None and 1e-4 < largest.value
    assert "bfloat16, cpu, press " in largest.case


def test_without_presses_the_rows_fail(tmp_path: Path) -> None:
    """And say what is missing."""
    rows = learned_precision.rows(tmp_path / "none.npz")
    assert [row.ok for row in rows] == [False, False]
    assert all("not measured" in row.case for row in rows)
