"""Results are brought up to date once edits have settled, and only where they are stale."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

from ui.desk.auto_update import SETTLED_S, AutoUpdate


class Widget:
    """A widget that remembers its value."""

    def __init__(self, value: Any = None) -> None:
        self.value, self.disabled = value, False

    def on_click(self, handler: Any) -> None:
        self.click = handler

    on_update = on_trigger = on_click


class StubDesk:
    """A desk whose results are fresh or not, as a test says."""

    def __init__(self) -> None:
        made = {"add_button": Widget(), "add_command": Widget(), "add_checkbox": Widget(False)}
        gui = SimpleNamespace(**{k: (lambda *a, w=w, **o: w) for k, w in made.items()})
        self.server = SimpleNamespace(gui=gui)
        self.live = False
        self.ready = {"press": True, "shoot": False}
        self.session = SimpleNamespace(fresh=lambda: self.ready)
        self.asked: list[tuple[str, tuple[str, ...]]] = []

    def guarded(self, handler: Any) -> Any:
        return handler

    def run(self, job: str, wanted: tuple[str, ...]) -> None:
        self.asked.append((job, wanted))


def test_an_update_waits_until_the_last_edit_has_settled() -> None:
    """Two edits .5 s apart: one request, 1.5 s after the second; none without the check box."""
    now = [0.0]
    desk = StubDesk()
    update = AutoUpdate(desk, lambda: now[0])  # pyright: ignore[reportArgumentType]
    update.edited()
    now[0] = 10.0
    update.turn()
    assert desk.asked == []
    update.auto.value = True
    for at_s in (20.0, 20.5):
        now[0] = at_s
        update.edited()
    now[0] = 20.4 + SETTLED_S
    update.turn()
    assert desk.asked == []
    now[0] = 20.5 + SETTLED_S
    update.turn()
    update.turn()
    assert desk.asked == [("press", ("press", "shoot"))]


def test_nothing_is_computed_that_is_up_to_date() -> None:
    """Fresh results: the button is off, and neither it nor the timer asks for anything."""
    now = [0.0]
    desk = StubDesk()
    desk.ready["shoot"] = True
    update = AutoUpdate(desk, lambda: now[0])  # pyright: ignore[reportArgumentType]
    update.auto.value = True
    update.edited()
    now[0] = 9.0
    update.turn()
    update.button.click(None)
    update.refresh()
    assert desk.asked == [] and update.button.disabled
    desk.ready["press"] = False
    update.button.click(None)
    update.refresh()
    assert len(desk.asked) == 1 and not update.button.disabled
