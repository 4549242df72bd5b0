"""Which build of PyTorch `make setup` asks for, and that asking never hangs."""

from __future__ import annotations

import importlib.util
import time
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

FILE = Path(__file__).parents[2] / ".ci" / "torch_index.py"


@pytest.fixture
def chooser(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    """The script as a module, on Linux, without an index of the reader's own."""
    spec = importlib.util.spec_from_file_location("torch_index", FILE)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    for name in module.CHOSEN:
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr(module.platform, "system", lambda: "Linux")
    return module


@pytest.mark.parametrize(
    ("driver", "answers", "index"),
    [(False, True, True), (False, False, False), (True, True, False), (True, False, False)],
)
def test_the_cpu_build_is_asked_for_without_a_driver_only(
    driver: bool, answers: bool, index: bool, chooser: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    """With a driver, or without an answer of the index, pip takes what it finds."""
    monkeypatch.setattr(chooser, "has_nvidia_driver", lambda: driver)
    monkeypatch.setattr(chooser, "reachable", lambda address: answers)
    assert chooser.options() == (f"--extra-index-url {chooser.CPU_INDEX}" if index else "")


def test_an_index_of_the_readers_own_stays(chooser: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """Whoever has set one knows why."""
    monkeypatch.setenv("PIP_EXTRA_INDEX_URL", "https://packages.example/simple")
    assert chooser.options() == ""


def test_a_driver_or_an_index_that_hangs_counts_as_none(
    chooser: Any, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """A program that sleeps for a minute, and a port that accepts nothing."""
    monkeypatch.setattr(chooser, "WAIT_S", 0.5)
    slow = tmp_path / "nvidia-smi"
    slow.write_text("#!/bin/sh\nsleep 60\n")
    slow.chmod(0o755)
    monkeypatch.setenv("PATH", str(tmp_path), prepend=":")
    began = time.monotonic()
    assert not chooser.has_nvidia_driver()
    # An address that is not routed (RFC 5737, TEST-NET-1).
    assert not chooser.reachable("http://192.0.2.1")
    assert time.monotonic() - began < 5.0
