"""The zip of all parts: made where it is not there yet, sent to who asked once it is."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from ui.panels.make.downloads import Downloads

PARTS: Any = (SimpleNamespace(name="core"),)


class Bench:
    """Downloads on a desk whose package has a key, and is there or not."""

    def __init__(self) -> None:
        self.key, self.fresh, self.made = "thin", False, 0
        self.sent: list[str] = []
        session = SimpleNamespace(
            fresh=lambda: {"package": self.fresh},
            calls=lambda: {"package": SimpleNamespace(key=self.key)},
            result=lambda stage: SimpleNamespace(files={"core.stl": np.zeros(4, np.uint8)}),
            design=SimpleNamespace(name="mine"),
        )
        self.downloads = Downloads.__new__(Downloads)
        self.downloads._waiting = None
        self.downloads.desk = SimpleNamespace(session=session)  # pyright: ignore[reportAttributeAccessIssue]
        self.downloads.folder = self.downloads.part = SimpleNamespace()
        send = lambda name, data, save_immediately: self.sent.append(name)  # noqa: E731
        self.event = SimpleNamespace(client=SimpleNamespace(send_file_download=send))

    def ask(self) -> None:
        self.downloads.all(self.event, self._make)

    def _make(self, event: Any) -> None:
        self.made += 1

    def finish(self) -> None:
        self.fresh = True
        self.downloads.offer(PARTS)


@pytest.fixture
def bench() -> Bench:
    return Bench()


def test_what_is_there_is_sent_at_once(bench: Bench) -> None:
    """Nothing is made."""
    bench.fresh = True
    bench.ask()
    assert bench.sent == ["mine-parts.zip"] and bench.made == 0


def test_what_is_not_there_is_made_and_sent_once(bench: Bench) -> None:
    """Parts without their files, while they are written, are no reason to forget who waits."""
    bench.ask()
    bench.downloads.offer(())
    assert bench.made == 1 and not bench.sent
    bench.finish()
    bench.downloads.offer(PARTS)
    assert bench.sent == ["mine-parts.zip"]


def test_parts_of_another_design_are_sent_to_nobody(bench: Bench) -> None:
    """Edited meanwhile: the files that come are not those that were asked for."""
    bench.ask()
    bench.key = "thick"
    bench.finish()
    assert not bench.sent
