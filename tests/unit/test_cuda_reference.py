"""CPU beside CUDA, where there is CUDA and where there is only a file."""

from __future__ import annotations

import dataclasses
import json
from pathlib import Path

import numpy as np
import pytest

from workbench.core.base.errors import DeviceError, LaneError, StoreError
from workbench.proof.validation.contact import cuda_reference, repeat

CPU = {"finger_sheared_N": np.array([[0.0, 0.0, 2.0]]), "block_N": np.array([[0.0, 3.0, 4.0]])}


@pytest.fixture
def without_cuda(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Path:
    path = tmp_path / "cuda_reference.json"
    moved = dataclasses.replace(cuda_reference.RECORD, path=path)
    monkeypatch.setattr(cuda_reference, "RECORD", moved)
    monkeypatch.setattr(cuda_reference, "cuda_count", lambda: 0)
    monkeypatch.setattr(repeat, "elsewhere", lambda **_: CPU)
    return path


def test_difference_is_the_largest_over_its_own_press(without_cuda: Path) -> None:
    """Forces 2 against 2 and (3, 4) against (3, 5): 1 over 5 = 0.2."""
    record = {"device": "a card", "made": "2020-01-01", "finger_sheared_N": [[0.0, 0.0, 2.0]]}
    without_cuda.write_text(json.dumps({**record, "block_N": [[0.0, 3.0, 5.0]]}))
    assert cuda_reference.difference() == pytest.approx(0.2)
    assert "a card, 2020-01-01" in cuda_reference.how()


def test_without_cuda_and_file_there_is_no_difference(without_cuda: Path) -> None:
    """The message names the file, the hint the command that writes it."""
    with pytest.raises(StoreError, match=r"cuda_reference\.json cannot be read") as raised:
        cuda_reference.difference()
    assert "python -m workbench.proof.validation.contact.cuda_reference" in raised.value.hint
    assert "no figures" in cuda_reference.how()
    assert not without_cuda.exists()


@pytest.mark.usefixtures("without_cuda")
def test_the_file_is_only_written_from_cuda() -> None:
    """A CPU's forces must not pass for a CUDA device's."""
    with pytest.raises(DeviceError, match="0 CUDA devices"):
        cuda_reference.write()


def test_a_press_that_fails_elsewhere_says_why() -> None:
    """An unknown device ends the other process; its last words come back."""
    with pytest.raises(LaneError, match="ended with") as raised:
        repeat.elsewhere(WORKBENCH_DEVICE="abacus")
    assert "abacus" in raised.value.hint


def test_bytes_that_differ_are_counted(monkeypatch: pytest.MonkeyPatch) -> None:
    """1.0 and its neighbour differ in one byte of eight."""
    results = iter([{"force": np.array([1.0, 2.0])}, {"force": np.array([np.nextafter(1, 2), 2])}])
    monkeypatch.setattr(repeat, "elsewhere", lambda **_: next(results))
    assert repeat.differing_bytes() == 1.0
