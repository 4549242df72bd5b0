"""What a failed press says when its settled frames cannot be written."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from workbench.core.base.errors import DeviceError, OpticsError, SolveError, StoreError
from workbench.core.design.design import SensorDesign
from workbench.core.press.press_case import PressCase
from workbench.pipeline.stage import Ref
from workbench.report import partial

REASONS = (
    StoreError("cannot write summary.json: the disk is full", hint="free some space"),
    DeviceError("no compute device"),
    OpticsError("the camera sees no skin"),
)


@pytest.fixture
def error() -> SolveError:
    failed = SolveError("frame 3 of 5 did not settle", hint="lower the depth", at="press.depth_mm")
    failed.kept = "key"
    return failed


@pytest.mark.parametrize("reason", REASONS, ids=lambda reason: type(reason).__name__)
def test_an_error_while_writing_does_not_replace_that_of_the_press(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, error: SolveError, reason: Exception
) -> None:
    """The press's own error is raised; its hint ends with what kept the frames from disk."""

    def unwritable(*args: object, **keywords: object) -> Any:
        raise reason

    monkeypatch.setattr(partial, "run", unwritable)
    design: Any = SensorDesign(name="any", family="finger")
    with pytest.raises(SolveError) as caught:
        with partial.keeping_partial(tmp_path, design, PressCase(), Any, ()):  # type: ignore[arg-type]
            raise error
    assert caught.value is error
    assert error.message == "frame 3 of 5 did not settle"
    assert error.hint == f"lower the depth; what settled was not written: {reason.args[0]}"
    assert list(tmp_path.iterdir()) == []


def test_rendering_what_settled_is_told(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, error: SolveError
) -> None:
    """The monitor of the run hears of stage `shoot`, on the settled frames of that key."""
    heard: list[tuple[str, float, str]] = []

    def rendered(store: Any, call: Any, monitor: Any) -> Any:
        assert Ref(stage="press_partial", key="key") in call.values
        monitor(0.5, "frame 1")
        raise StoreError("enough")

    monkeypatch.setattr(partial, "run", rendered)
    design, store = SensorDesign(name="any", family="finger"), SimpleNamespace()

    def told(stage: str, fraction: float, note: str) -> None:
        heard.append((stage, fraction, note))

    with pytest.raises(SolveError):
        with partial.keeping_partial(tmp_path, design, PressCase(), store, (), monitor=told):  # type: ignore[arg-type]
            raise error
    assert heard == [("shoot", 0.5, "frame 1")]
