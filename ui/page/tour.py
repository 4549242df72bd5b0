"""The tour of three steps: a window above the sensor, which opens the tab it speaks of.

It belongs to one tab of the browser and covers neither docks nor timeline, so that what it tells of
can be tried while it is on show. viser cannot choose a tab from here, so a step runs a line of
script in the page: it presses Enter on the tab (viser's tabs take no clicks of a script), and a
frame glows around all that the step points at.
"""

from __future__ import annotations

import html
import json
import time
from collections.abc import Callable
from typing import Any, NamedTuple

from ui.patches.image_click import PIXEL_GIF

NEXT, CLOSE = "Next", "Close"
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


STEPS = (
    Step(
        "1 of 3: shape the sensor",
        "On the left, under **Shape**, choose where to start from and drag a slider: the body "
        "below follows. Every number has a unit and a hint; what cannot be made is refused with "
        "the limit, and **Undo** (Ctrl + Z) takes anything back.",
        ("Shape",),
    ),
    Step(
        "2 of 3: press it",
        "On the left, under **Simulate**, choose an object, click the skin where it shall press, "
        "then *Run press* (R). On the right stand the **Tactile image** and the **Forces**; the "
        "timeline at the bottom plays the frames (P).",
        ("Simulate", "Tactile image", "Forces"),
    ),
    Step(
        "3 of 3: compare, make",
        "The line of stages at the top left says what is up to date (✓) and what is stale (○). "
        "**Compare** keeps variants; **Make** checks walls and writes moulds and parts. All is "
        "saved as you go; Ctrl + K finds every command, H shows the keys.",
        ("Compare", "Make"),
    ),
)


def pointing(tabs: tuple[str, ...], turn: int) -> str:
    """The script that opens the first tab and lets all of them glow, as HTML that runs it once."""
    source = POINT.replace("NAMES", json.dumps(tabs)).replace("TURN", str(turn))
    script = html.escape(" ".join(source.split()), quote=True)
    return f'<img alt="" style="display:none" src="{PIXEL_GIF}" onload="{script}">'


class Tour:
    """At most one window per tab."""

    def __init__(self, server: Any) -> None:
        self._open: dict[int, tuple[Any, Any]] = {}
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

    def close(self, client: Any) -> None:
        """Take the window of a tab away, if there is one."""
        found = self._open.pop(client.client_id, None)
        if found is not None:
            for handle in found:
                handle.remove()

    async def _left(self, client: Any) -> None:
        self._open.pop(client.client_id, None)
