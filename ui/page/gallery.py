"""A gallery: cards with thumbnails in a window of one tab, from which one is chosen.

viser has no clickable images, so the cards are HTML, and a click on one presses the button of the
same name below; those buttons are what a keyboard and a screen reader find.
"""

from __future__ import annotations

import base64
import html
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from ui.page.editor import Editor

PRESS = (
    "const wanted=this.dataset.name;"
    "for(const b of document.querySelectorAll('.mantine-Modal-content button'))"
    "if(b.innerText.trim()===wanted){b.click();break}"
)
"""Presses the button of the window whose text is the card's name."""
GRID = "display:grid;grid-template-columns:repeat(auto-fill,minmax(105px,1fr));gap:8px;margin:6px"
CARD = (
    "border:1px solid #8886;border-radius:8px;padding:6px;cursor:pointer;text-align:center;"
    "font-size:11px;line-height:1.25"
)
THUMBNAIL = "width:100%;height:76px;object-fit:contain"
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


class Galleries:
    """At most one gallery per tab, and only in the tab that edits.

    What stands in a tab's own GUI passes `ui.page.incoming`, so that a choice is asked about here.
    """

    def __init__(self, server: Any, editor: Editor) -> None:
        self.editor = editor
        self._open: dict[int, Any] = {}
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
            gui.add_html(cards_html(cards))
            names = [card.name for card in cards]
            for start in range(0, len(names), IN_A_ROW):
                label = "Choose" if start == 0 else ""
                row = gui.add_button_group(label, tuple(names[start : start + IN_A_ROW]))
                row.on_click(chosen)
            gui.add_button("Close", color="gray").on_click(lambda event: self.close(tab))
        self._open[tab] = window
        if not self.editor.edits(tab):
            # Another tab took over while the cards were being laid out.
            self.close(tab)

    def close(self, tab: int) -> None:
        """Close the gallery of a tab, if there is one."""
        window = self._open.pop(tab, None)
        if window is not None:
            window.close()

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
    thumbnail = ""
    if card.png is not None:
        data = base64.b64encode(card.png).decode()
        thumbnail = f"<img alt='' style='{THUMBNAIL}' src='data:image/png;base64,{data}'>"
    else:
        thumbnail = f"<div style='{THUMBNAIL};font-size:48px;opacity:.4'>&#9633;</div>"
    words = f"<br><span style='opacity:.7'>{html.escape(card.words)}</span>" if card.words else ""
    return (
        f'<div style=\'{CARD}\' data-name="{name}" title="{name}" onclick="{PRESS}">'
        f"{thumbnail}<b>{name}</b>{words}</div>"
    )
