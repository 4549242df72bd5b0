"""Help in the page: a sheet for each panel, the keyboard map, and a tour.

The texts of the panels stand beside these, those of the tour are in `tour.py`.
The tour is shown once per browser, which remembers it (`localStorage`), and again on request.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from ui.page.incoming import Incoming
from ui.page.keys import keyboard_map, registered
from ui.page.sheet import Sheets
from ui.page.tour import Tour

SEEN = "workbench-tour-seen"


class Help:
    """Help of one server; `texts` are the sheets by the label of the page, as Markdown."""

    def __init__(self, server: Any, incoming: Incoming, texts: Mapping[str, str]) -> None:
        self.server = server
        self.texts = texts
        self.incoming = incoming
        self.sheets = Sheets(server)
        self.steps = Tour(server)
        self._command("Tour", self.tour)
        self._command("Keyboard map", self.show_keys, hotkey="H")
        for panel in texts:
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
        self.sheets.show(client, f"Help: {panel}", self.texts[panel], more)

    def show_keys(self, client: Any) -> None:
        """Show all commands and their keys."""
        self.sheets.show(client, "Keyboard map", keyboard_map(registered(self.server.gui)))

    def tour(self, client: Any) -> None:
        """Begin the tour; the browser remembers once it was ended or skipped."""
        self.steps.show(client, 0, lambda: client.local_storage.set_item(SEEN, "1"))

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
