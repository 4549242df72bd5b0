"""What of a state is on show once a stage has ended."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

from ui.desk.shown_results import ShownResults
from workbench.pipeline.stage import Outcome


class Stored:
    """A store in which shot and maps are, once they have been computed, and the session of it."""

    def __init__(self) -> None:
        self.there: set[str] = set()
        self.store = self

    def has(self, stage: str, key: str) -> bool:
        return key in self.there

    def load(self, stage: str, key: str) -> Any:
        return f"result {key}"

    def calls(self) -> dict[str, Any]:
        return {stage: SimpleNamespace(key=f"{stage}-1") for stage in ("shoot", "maps")}


class Background:
    """Does at once what it is asked for."""

    def ask(self, job: str, work: Any, take: Any) -> None:
        for result in work:
            take(result)


def test_maps_that_came_with_an_image_are_shown_with_it() -> None:
    """They are computed as a part of it, and no event tells so."""
    session: Any = Stored()
    background: Any = Background()
    shown = ShownResults(session, background)
    told: list[str] = []
    shown.on_result.connect(lambda stage, result: told.append(stage))
    session.there |= {"shoot-1", "maps-1"}
    shown.stage_done(Outcome(stage="shoot", key="shoot-1", cached=False, seconds=1.0))
    assert sorted(told) == ["maps", "shoot"]
    assert shown.current("maps")
