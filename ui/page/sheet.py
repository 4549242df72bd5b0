"""A sheet of text over one tab: help, the keyboard map, the tour. Closed by its button or Escape.

It belongs to the tab that asked (`client.gui`), so that nobody else's view is covered, and a tab
that follows may read it too.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

CLOSE = "Close"


class Sheets:
    """At most one sheet per tab."""

    def __init__(self, server: Any) -> None:
        self._open: dict[int, tuple[Any, Any]] = {}
        server.on_client_disconnect(self._left)

    def show(
        self,
        client: Any,
        title: str,
        text: str,
        buttons: Mapping[str, Callable[[], None]] | None = None,
        *,
        on_close: Callable[[], None] = lambda: None,
    ) -> None:
        """Put a sheet over a tab, in place of the one there.

        Args:
            client: The tab.
            title: Above the text.
            text: Markdown, written by the workbench itself.
            buttons: What else can be clicked, each with what it does; the sheet stays for it.
            on_close: Called when the sheet is closed by hand.
        """
        self.close(client)

        def closed(event: Any) -> None:
            self.close(client)
            on_close()

        gui = client.gui
        with gui.add_modal(title) as modal:
            gui.add_markdown(text)
            for label, act in (buttons or {}).items():
                gui.add_button(label).on_click(lambda event, act=act: act())
            gui.add_button(CLOSE, color="gray", hint="Escape").on_click(closed)
        escape = gui.add_command(f"Close: {title}", hotkey="escape")
        escape.on_trigger(closed)
        self._open[client.client_id] = (modal, escape)

    def close(self, client: Any) -> None:
        """Take the sheet of a tab away, if there is one."""
        found = self._open.pop(client.client_id, None)
        if found is not None:
            modal, escape = found
            modal.close()
            escape.remove()

    async def _left(self, client: Any) -> None:
        self._open.pop(client.client_id, None)
