"""A dark page or a light one: as the system prefers, until a browser chooses by a command.

The choice is remembered by the browser (`localStorage`).
"""

from __future__ import annotations

import time
from typing import Any

from ui.page.incoming import Incoming
from ui.patches.system_theme import SYSTEM, system_theme

BRAND = (37, 99, 235)
STORED = "workbench-page"
LIGHT, DARK = "light", "dark"
ANSWER_S = 20.0
TOLD_S = 15.0
"""How long a page that is being loaded may take until it has told what its system prefers [s]."""
AGAIN_S = 0.3


class Theme:
    """How the page is coloured; dark until it is known what the browser wants."""

    def __init__(self, server: Any, incoming: Incoming) -> None:
        _colour(server.gui, DARK)
        server.gui.add_html(system_theme())
        server.on_client_connect(_follow)
        command = server.gui.add_command("Light or dark page")
        command.on_trigger(lambda event: _turn(event.client))
        incoming.open_to_all(command)


def _colour(gui: Any, choice: str) -> None:
    gui.configure_theme(
        dark_mode=choice == DARK, show_logo=False, show_share_button=False, brand_color=BRAND
    )


def _follow(client: Any) -> None:
    """Colour a tab as its browser has chosen, else as its system prefers."""
    end_s = time.monotonic() + TOLD_S
    try:
        wanted = client.local_storage.get_item(STORED, timeout=ANSWER_S)
        while wanted is None and time.monotonic() < end_s:
            wanted = client.local_storage.get_item(SYSTEM, timeout=ANSWER_S)
            if wanted is None:
                time.sleep(AGAIN_S)
    except (RuntimeError, TimeoutError):
        # A browser that keeps no storage, or a tab that is gone.
        return
    if wanted == LIGHT:
        _colour(client.gui, LIGHT)


def _wanted(client: Any) -> str:
    """How a tab is coloured; one whose browser keeps no storage is dark."""
    try:
        stored = client.local_storage
        return stored.get_item(STORED, timeout=ANSWER_S) or stored.get_item(SYSTEM) or DARK
    except (RuntimeError, TimeoutError):
        return DARK


def _turn(client: Any) -> None:
    choice = LIGHT if _wanted(client) == DARK else DARK
    client.local_storage.set_item(STORED, choice)
    _colour(client.gui, choice)
