"""The tour: a window above the sensor that lets the visitor do each step, and opens its tab.

A step that awaits something goes on by itself once it has happened, whoever did it, and the hand
has rested: the tab under a slider must not change while it is dragged. *Next* leaves a step out.

The window belongs to one tab of the browser and covers neither docks nor timeline, so that what it
tells of can be done while it is on show. viser cannot choose a tab from here, so a step runs a line
of script in the page: it presses Enter on the tab (viser's tabs take no clicks of a script), and a
frame glows around all that the step points at.
"""

from __future__ import annotations

import json
import threading
import time
from collections.abc import Callable
from functools import partial
from typing import Any, NamedTuple

from ui.patches.image_click import script_in_html

NEXT, CLOSE = "Next", "Close"
REST_S = 2.5
"""So long after something was done last the tour goes on [s]."""
WIDTH_PX = 500
"""Room between the docks on a page of 1280 pixels, less a margin on both sides."""
POINT = """
if (window.tourShown >= TURN) return;
window.tourShown = TURN;
const names = NAMES;
const all = [...document.querySelectorAll('[role=tab]')];
const find = name => all.find(tab => tab.innerText.trim() === name);
const first = find(names[0]);
if (first) first.dispatchEvent(new KeyboardEvent('keydown', {key: 'Enter', bubbles: true}));
for (const tab of names.map(find)) if (tab) tab.animate(
  [{boxShadow: 'inset 0 0 0 2px #f5a623'}, {boxShadow: 'inset 0 0 0 2px #f5a62300'}],
  {duration: 1200, iterations: 3});
"""
"""Opens the first of the tabs named, and lets all of them glow for some seconds. The page mounts a
window more than once, also one that is about to go: what was shown before is not shown again."""

ASIDE = '<style>.mantine-Notifications-root[data-position="top-left"]{top:175px !important}</style>'
"""Notifications come in below the window while it is there: they would lie on its buttons."""


class Step(NamedTuple):
    """What is told at once."""

    title: str
    text: str
    """Markdown."""
    tabs: tuple[str, ...]
    """Tabs that the step points at; the first is opened."""
    awaits: str = ""
    """What the visitor does, by its name here; "" where there is nothing to do."""


SHAPED, PRESSED, ENLARGED = "shaped", "pressed", "enlarged"
STEPS = (
    Step(
        "1 of 4: shape the sensor",
        "Under **Shape** on the left, drag **Outer radius mm**: the body below follows. What "
        "cannot be made is refused with the limit, and **Undo** (Ctrl + Z) takes anything back.",
        ("Shape",),
        SHAPED,
    ),
    Step(
        "2 of 4: press it",
        "Click the skin where a ball shall press it, then **Run press** (R): contact, light "
        "and image are computed for your shape, one to two minutes on two cores. Meanwhile, look "
        "at the objects under **Simulate**, or turn the sensor by a drag.",
        ("Simulate", "Tactile image", "Forces"),
        PRESSED,
    ),
    Step(
        "3 of 4: see what it feels",
        "Press I: the tactile image stands large beside the sensor (W: over the page). "
        "J and K step through the frames, **Rest on the left %** wipes over to the "
        "untouched skin. The figures at the top left each open their reason.",
        ("Tactile image",),
        ENLARGED,
    ),
    Step(
        "4 of 4: compare, make",
        "The line of stages at the top left says what is up to date (✓) and what is stale (○). "
        "**Compare** keeps variants; **Make** checks walls and writes moulds and parts. All is "
        "saved as you go; Ctrl + K finds every command, H shows the keys.",
        ("Compare", "Make"),
    ),
)


def pointing(tabs: tuple[str, ...], turn: int) -> str:
    """The script that opens the first tab and lets all of them glow, as HTML that runs it once."""
    source = POINT.replace("NAMES", json.dumps(tabs)).replace("TURN", str(turn))
    return script_in_html(source)


class Tour:
    """At most one window per tab."""

    def __init__(self, server: Any) -> None:
        self._open: dict[int, tuple[Any, Any]] = {}
        self._going_on: dict[int, tuple[str, Callable[[], None]]] = {}
        """What each tab's step awaits, and what shows the next."""
        self._soon: threading.Timer | None = None
        server.on_client_disconnect(self._left)

    def show(self, client: Any, number: int, on_end: Callable[[], None]) -> None:
        """Show a step in a tab.

        Args:
            client: The tab.
            number: Of the step, from 0.
            on_end: Called when the window is closed by hand, and with the last step.
        """
        self.close(client)
        step, last = STEPS[number], number == len(STEPS) - 1

        def ended(event: Any) -> None:
            self.close(client)
            on_end()

        def chosen(event: Any) -> None:
            if event.target.value == NEXT:
                self.show(client, number + 1, on_end)
            else:
                ended(event)

        gui = client.gui
        panel = gui.add_panel()
        with panel.add_tab(step.title):
            gui.add_markdown(step.text)
            buttons = gui.add_button_group("", (CLOSE,) if last else (NEXT, CLOSE))
            buttons.on_click(chosen)
            gui.add_html(ASIDE + pointing(step.tabs, time.time_ns() // 1_000_000))
        panel.float(x=15, y=15, width=WIDTH_PX)
        escape = gui.add_command(f"Close: {step.title}", hotkey="escape")
        escape.on_trigger(ended)
        self._open[client.client_id] = (panel, escape)
        if last:
            on_end()
        else:
            go_on = partial(self.show, client, number + 1, on_end)
            self._going_on[client.client_id] = (step.awaits, go_on)

    def happened(self, what: str) -> None:
        """Go on in all tabs whose step awaits this, once nothing more happens."""
        if any(awaits == what for awaits, _ in list(self._going_on.values())):
            if self._soon is not None:
                self._soon.cancel()
            self._soon = threading.Timer(REST_S, self._go_on, (what,))
            self._soon.daemon = True
            self._soon.start()

    def _go_on(self, what: str) -> None:
        for awaits, go_on in list(self._going_on.values()):
            if awaits == what:
                go_on()

    def close(self, client: Any) -> None:
        """Take the window of a tab away, if there is one."""
        self._going_on.pop(client.client_id, None)
        found = self._open.pop(client.client_id, None)
        if found is not None:
            for handle in found:
                handle.remove()

    async def _left(self, client: Any) -> None:
        self._open.pop(client.client_id, None)
        self._going_on.pop(client.client_id, None)
