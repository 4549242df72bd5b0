"""A gallery: cards with pictures in a window of one tab, from which one is chosen.

viser has no clickable pictures, so the cards are HTML, and a click on one presses the button of the
same name below; those buttons are what a keyboard and a screen reader find.
"""

from __future__ import annotations

import base64
import html
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

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
PICTURE = "width:100%;height:76px;object-fit:contain"
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


def open_gallery(
    gui: Any, title: str, cards: Sequence[Card], choose: Callable[[str], None]
) -> None:
    """Open a window with cards in one tab; it closes with the choice.

    Args:
        gui: The tab's own GUI.
        title: Of the window.
        cards: In their order; cards of a group stand together.
        choose: Called with the name of the chosen card.
    """
    window = gui.add_modal(title)

    def chosen(event: Any) -> None:
        window.close()
        choose(event.target.value)

    with window:
        gui.add_html(cards_html(cards))
        names = [card.name for card in cards]
        for start in range(0, len(names), IN_A_ROW):
            label = "Choose" if start == 0 else ""
            row = gui.add_button_group(label, tuple(names[start : start + IN_A_ROW]))
            row.on_click(chosen)
        gui.add_button("Close", color="gray").on_click(lambda event: window.close())


def cards_html(cards: Sequence[Card]) -> str:
    """All cards, under the headings of their groups, as HTML."""
    groups = list(dict.fromkeys(card.group for card in cards))
    parts = []
    for group in groups:
        head = f"<div style='margin:10px 8px 0'><b>{html.escape(group)}</b></div>" if group else ""
        inside = "".join(_card(card) for card in cards if card.group == group)
        parts.append(f"{head}<div style='{GRID}'>{inside}</div>")
    return "".join(parts)


def _card(card: Card) -> str:
    name = html.escape(card.name, quote=True)
    picture = ""
    if card.png is not None:
        data = base64.b64encode(card.png).decode()
        picture = f"<img alt='' style='{PICTURE}' src='data:image/png;base64,{data}'>"
    else:
        picture = f"<div style='{PICTURE};font-size:48px;opacity:.4'>&#9633;</div>"
    words = f"<br><span style='opacity:.7'>{html.escape(card.words)}</span>" if card.words else ""
    return (
        f'<div style=\'{CARD}\' data-name="{name}" title="{name}" onclick="{PRESS}">'
        f"{picture}<b>{name}</b>{words}</div>"
    )
