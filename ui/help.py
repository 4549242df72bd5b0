"""Help in the page: a sheet for each panel, the keyboard map, and a tour of three steps.

The texts are Markdown files beside this module. The tour is shown once per browser, which remembers
it (`localStorage`), and again on request.
"""

from __future__ import annotations

from importlib import resources
from typing import Any

from ui.incoming import Incoming
from ui.keys import keyboard_map, registered
from ui.sheet import Sheets

PANELS = ("Shape", "Mesh", "Optics", "Simulate", "Make", "Compare", "Results", "View")
SEEN = "workbench-tour-seen"
STEPS = (
    (
        "1 of 3: shape the sensor",
        "The left dock is the design. On **Shape** choose where to start from and drag a slider: "
        "the body in the middle follows. Every number has a unit and a hint; what cannot be made "
        "is refused with the limit, and **Undo** (Ctrl + Z) takes anything back.",
    ),
    (
        "2 of 3: press it",
        "On **Simulate** choose an object, click the skin where it shall press, and *Run press* "
        "(R). A running job shows its progress and can be cancelled. The right dock shows the "
        "tactile image and the forces; the timeline plays the frames (P).",
    ),
    (
        "3 of 3: compare and make",
        "The line of stages on top says what is up to date (✓) and what is stale (○). **Compare** "
        "keeps variants and puts two side by side; **Make** checks the walls and writes moulds "
        "and parts. Everything is saved as you go. Ctrl + K finds every command, H shows the keys.",
    ),
)


def page(panel: str) -> str:
    """The help of a panel as Markdown."""
    file = resources.files("ui") / "help_pages" / f"{panel.lower()}.md"
    return file.read_text(encoding="utf-8")


class Help:
    """Help of one server."""

    def __init__(self, server: Any, incoming: Incoming) -> None:
        self.server = server
        self.incoming = incoming
        self.sheets = Sheets(server)
        self._command("Tour", self.tour)
        self._command("Keyboard map", self.show_keys, hotkey="H")
        for panel in PANELS:
            self._command(f"Help on {panel}", lambda client, panel=panel: self.show(client, panel))

    def button(self, panel: str) -> None:
        """Put the panel's help button where widgets are being added."""
        hint = f"What {panel} is for, its steps, keys and units"
        handle = self.server.gui.add_button(f"Help: {panel}", color="gray", hint=hint)
        handle.on_click(lambda event: self.show(event.client, panel))
        self.incoming.open_to_all(handle)

    def show(self, client: Any, panel: str) -> None:
        """Show the help of a panel in the tab that asked."""
        more = {"Keyboard map": lambda: self.show_keys(client), "Tour": lambda: self.tour(client)}
        self.sheets.show(client, f"Help: {panel}", page(panel), more)

    def show_keys(self, client: Any) -> None:
        """Show all commands and their keys."""
        self.sheets.show(client, "Keyboard map", keyboard_map(registered(self.server.gui)))

    def tour(self, client: Any, step: int = 0) -> None:
        """Show a step of the tour; the browser remembers once it was ended or skipped."""
        title, text = STEPS[step]
        last = step == len(STEPS) - 1
        further = {} if last else {"Next": lambda: self.tour(client, step + 1)}

        def seen() -> None:
            client.local_storage.set_item(SEEN, "1")

        if last:
            seen()
        self.sheets.show(client, title, text, further, on_close=seen)

    def begin(self) -> None:
        """Show the tour in every browser that has not seen it."""
        self.server.on_client_connect(self._welcome)

    def _welcome(self, client: Any) -> None:
        # A browser that keeps no storage raises: it would see the tour at every reload.
        try:
            seen = client.local_storage.get_item(SEEN, timeout=20.0)
        except (RuntimeError, TimeoutError):
            return
        if seen is None:
            self.tour(client)

    def _command(self, label: str, act: Any, *, hotkey: Any = None) -> None:
        command = self.server.gui.add_command(label, hotkey=hotkey)
        command.on_trigger(lambda event: act(event.client))
        self.incoming.open_to_all(command)
