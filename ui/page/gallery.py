"""A gallery: cards with thumbnails in a window of one tab, from which one is chosen.

viser has no clickable images, so the cards are buttons in HTML: Tab reaches them, Enter and a click
choose. What they choose goes the way of viser's own buttons of the same names, which stand below
and are not shown. A card may lead to a page instead (`ui.patches.leading`). Escape closes.
"""

from __future__ import annotations

import base64
import html
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from ui.page.editor import Editor
from workbench.report import thumbnails

PRESS = (
    "const wanted=this.dataset.goto?'Close':this.dataset.name;"
    "for(const b of document.querySelectorAll('.mantine-Modal-content button'))"
    "if(b.textContent.trim()===wanted&&!b.dataset.name){b.click();break}"
)
"""Presses the button of the window whose text is the card's name, or closes it and leads on."""
GRID = "display:grid;grid-template-columns:repeat(auto-fill,minmax(105px,1fr));gap:8px;margin:6px"
CARD = (
    "border:1px solid #8886;border-radius:8px;padding:6px;cursor:pointer;text-align:center;"
    "font:inherit;font-size:11px;line-height:1.25;background:none;color:inherit;"
    # Pictures of a row stand at one height, however long the words below them.
    "display:flex;flex-direction:column;justify-content:flex-start"
)
HIDE = (
    "<style>.mantine-Modal-content:has([data-name]) .mantine-Flex-root:is(:has(> div > p > label),"
    ":has(> div > div > p > label)){display:none}"
    ".mantine-Modal-content:has([data-name])"
    "{flex:0 0 min(860px,calc(100vw - 24px)) !important}</style>"
)
"""viser's own buttons of the cards' names say all of them twice, and its windows are narrow."""
ICONS = {
    "body": "M12 3l8 4.5v9L12 21l-8-4.5v-9zM12 12l8-4.5M12 12v9M12 12L4 7.5",
    "photo": "M4 8h3l2-3h6l2 3h3v11H4zM12 10a3.5 3.5 0 1 0 0 7a3.5 3.5 0 1 0 0-7",
    "goals": "M12 3a9 9 0 1 0 0 18a9 9 0 1 0 0-18M12 8a4 4 0 1 0 0 8a4 4 0 1 0 0-8M12 12h.01",
}
"""Lines of what has no thumbnail, in a box of 24 by 24."""
THUMBNAIL = "width:100%;height:76px;object-fit:contain"
GROUND = "background:rgb({},{},{});border-radius:5px".format(*thumbnails.GROUND)
"""Behind all of them the same, whether their own ground is clear or not, as in Compare."""
IN_A_ROW = 5
"""Buttons of a row below the cards."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Card:
    """One thing to choose."""

    name: str
    """What it is called, and what its button says."""
    words: str = ""
    """One line about it."""
    png: bytes | None = None
    group: str = ""
    """Heading under which it stands."""
    icon: str = ""
    """Of `ICONS`, where there is no thumbnail."""
    goto: str = ""
    """Tab that it leads to, in place of being chosen."""
    fold: str = ""
    """Folder there that is opened."""


class Galleries:
    """At most one gallery per tab, and only in the tab that edits.

    What stands in a tab's own GUI passes `ui.page.incoming`, so that a choice is asked about here.
    """

    def __init__(self, server: Any, editor: Editor) -> None:
        self.editor = editor
        self._open: dict[int, tuple[Any, Any]] = {}
        editor.on_lost.append(self.close)
        server.on_client_disconnect(self._left)

    def show(
        self, client: Any, title: str, cards: Sequence[Card], choose: Callable[[str], None]
    ) -> None:
        """Open a window with cards in a tab, in place of the one there.

        It closes with the choice, or when another tab takes the editing over.

        Args:
            client: The tab.
            title: Of the window.
            cards: In their order; cards of a group stand together.
            choose: Called with the name of the chosen card.
        """
        tab, gui = client.client_id, client.gui
        self.close(tab)

        def chosen(event: Any) -> None:
            self.close(tab)
            if self.editor.edits(tab):
                choose(event.target.value)
            else:
                self.editor.remind(tab)

        with gui.add_modal(title) as window:
            gui.add_html(HIDE + cards_html(cards))
            names = [card.name for card in cards if not card.goto]
            for start in range(0, len(names), IN_A_ROW):
                label = "Choose" if start == 0 else ""
                row = gui.add_button_group(label, tuple(names[start : start + IN_A_ROW]))
                row.on_click(chosen)
            gui.add_button("Close", color="gray", hint="Escape").on_click(
                lambda event: self.close(tab)
            )
        escape = gui.add_command(f"Close: {title}", hotkey="escape")
        escape.on_trigger(lambda event: self.close(tab))
        self._open[tab] = window, escape
        if not self.editor.edits(tab):
            # Another tab took over while the cards were being laid out.
            self.close(tab)

    def close(self, tab: int) -> None:
        """Close the gallery of a tab, if there is one."""
        found = self._open.pop(tab, None)
        if found is not None:
            window, escape = found
            window.close()
            escape.remove()

    async def _left(self, client: Any) -> None:
        self._open.pop(client.client_id, None)


def cards_html(cards: Sequence[Card]) -> str:
    """All cards, under the headings of their groups, as HTML."""
    groups = list(dict.fromkeys(card.group for card in cards))
    parts = []
    for group in groups:
        head = f"<div style='margin:10px 8px 0'><b>{html.escape(group)}</b></div>" if group else ""
        inside = "".join(_card(card) for card in cards if card.group == group)
        parts.append(f"{head}<div style='{GRID}'>{inside}</div>")
    return "".join(parts)


def shortened(words: str, longest: int) -> str:
    """A text of at most so many letters, cut behind a whole word, with an ellipsis."""
    if len(words) <= longest:
        return words
    kept = words[:longest].rpartition(" ")[0] or words[: longest - 1]
    return kept.rstrip(" ,;:-") + "\N{HORIZONTAL ELLIPSIS}"


def _card(card: Card) -> str:
    name = html.escape(card.name, quote=True)
    if card.png is not None:
        data = base64.b64encode(card.png).decode()
        thumbnail = f"<img alt='' style='{THUMBNAIL};{GROUND}' src='data:image/png;base64,{data}'>"
    elif card.icon:
        line = "fill='none' stroke='currentColor' stroke-width='1.2' stroke-linejoin='round'"
        path = f"<path {line} d='{ICONS[card.icon]}'/>"
        thumbnail = (
            f"<svg aria-hidden='true' viewBox='-3 -3 30 30' style='{THUMBNAIL}'>{path}</svg>"
        )
    else:
        thumbnail = f"<div style='{THUMBNAIL};font-size:48px;opacity:.4'>&#9633;</div>"
    words = f"<span style='opacity:.85'>{html.escape(card.words)}</span>" if card.words else ""
    there = {"goto": card.goto, "fold": card.fold}
    lead = "".join(f' data-{k}="{html.escape(v)}"' for k, v in there.items() if v)
    return (
        f'<button type="button" style=\'{CARD}\' data-name="{name}"{lead} title="{name}" '
        f'onclick="{PRESS}">{thumbnail}<b>{name}</b>{words}</button>'
    )
