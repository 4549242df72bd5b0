"""A press that fails shows the frames that settled, and says which one failed."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from ui.desk.followers import Followers
from ui.panels.results.page import settled_note
from workbench.core.base.errors import SolveError, WorkbenchError
from workbench.planning.running import PARTIAL


class FakeDesk:
    """A desk whose press has the key `asked` and whose store keeps its settled frames."""

    def __init__(self) -> None:
        self.desk = self
        self.told: list[tuple[str, Any]] = []
        store = SimpleNamespace(
            has=lambda stage, key: (stage, key) == (PARTIAL, "asked"),
            load=lambda stage, key: f"frames of {key}",
        )
        calls = {"press": SimpleNamespace(key="asked")}
        self.session = SimpleNamespace(store=store, calls=lambda: calls)
        self.shown_results = SimpleNamespace(
            fetch=lambda stage, key, then: then(store.load(stage, key))
        )

    def _settled(self, contact: Any, error: Any) -> None:
        Followers._settled(self, contact, error)  # pyright: ignore

    def tell(self, stage: str, result: Any) -> None:
        self.told.append((stage, result))


def failed(kept: str) -> SolveError:
    """Frame 3 did not settle."""
    error = SolveError("frame 3 of 5 did not settle", frame=2, last_good=1)
    error.kept = kept
    return error


def test_kept_frames_of_the_press_asked_for_are_shown() -> None:
    """The panels are told the stored frames together with the error."""
    desk: Any = FakeDesk()
    error = failed("asked")
    Followers._failed(desk, error, "press")  # pyright: ignore[reportPrivateUsage]
    assert desk.told == [("partial", ("frames of asked", error))]


@pytest.mark.parametrize("error", [failed(""), failed("another"), WorkbenchError("anything")])
def test_frames_of_another_press_are_not_shown(error: WorkbenchError) -> None:
    """Nothing kept, another press's frames, or another error: nothing changes on screen."""
    desk: Any = FakeDesk()
    Followers._failed(desk, error, "press")  # pyright: ignore[reportPrivateUsage]
    assert desk.told == []


def test_the_note_names_the_failed_frame() -> None:
    """Frames are counted from 1 for people."""
    assert settled_note(2, 2) == "frame 3 failed; frames 1..2 are shown"
    assert settled_note(1, 1) == "frame 2 failed; frame 1 is shown"
