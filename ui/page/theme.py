"""A dark page or a light one: each browser chooses by a command, and remembers (`localStorage`).

viser neither follows the system nor tells the server what it prefers.
"""

from __future__ import annotations

from typing import Any

from ui.page.incoming import Incoming

BRAND = (37, 99, 235)
STORED = "workbench-page"
LIGHT, DARK = "light", "dark"


class Theme:
    """How the page is coloured; dark until a browser has chosen otherwise."""

    def __init__(self, server: Any, incoming: Incoming) -> None:
        _colour(server.gui, DARK)
        server.on_client_connect(_remembered)
        command = server.gui.add_command("Light or dark page")
        command.on_trigger(lambda event: _turn(event.client))
        incoming.open_to_all(command)


def _colour(gui: Any, choice: str) -> None:
    gui.configure_theme(
        dark_mode=choice == DARK, show_logo=False, show_share_button=False, brand_color=BRAND
    )


def _stored(client: Any) -> str:
    """What the browser chose; one that keeps no storage raises and stays dark."""
    try:
        return client.local_storage.get_item(STORED, timeout=20.0) or DARK
    except (RuntimeError, TimeoutError):
        return DARK


def _remembered(client: Any) -> None:
    if _stored(client) == LIGHT:
        _colour(client.gui, LIGHT)


def _turn(client: Any) -> None:
    choice = LIGHT if _stored(client) == DARK else DARK
    client.local_storage.set_item(STORED, choice)
    _colour(client.gui, choice)
