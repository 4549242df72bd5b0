"""The headline as HTML: a row of figures, each of which opens its reason and leads to its page.

A mark of its own shape stands beside the colour, so that hue is never the only carrier. The reason
opens below the row, with a button that leads to its page.
"""

from __future__ import annotations

import html
from collections.abc import Sequence

from ui.patches.leading import leading
from workbench.view.headline import Shown, Standing

MARKS = {
    Standing.GOOD: ("●", "good"),
    Standing.FAIR: ("▲", "fair"),
    Standing.POOR: ("■", "poor"),
    Standing.PLAIN: ("", "plain"),
    Standing.OPEN: ("○", "open"),
}
"""Shape and class of each standing."""
BUTTONS = {"Maps": "Measure maps"}
"""What is pressed in a tab that a figure leads to: there the skin is painted by what it sees."""


def headline_html(shown: Sequence[Shown]) -> str:
    """The row; what is of the design before the last edits stands faded, in brackets."""
    chips = "".join(_chip(one) for one in shown)
    return f'<div class="headline">{chips}</div>'


def _chip(one: Shown) -> str:
    mark, kind = MARKS[one.standing]
    kind = f"{kind} old" if one.old else kind
    word = html.escape(one.headline.word)
    text = html.escape(f"({one.text})" if one.old else one.text)
    standing, tab = one.standing.value, one.headline.tab
    lead = {"goto": tab} | ({"press": BUTTONS[tab]} if tab in BUTTONS else {})
    return (
        f'<details name="headline" class="{kind}">'
        f'<summary title="{word}: {text}, {standing}"><span>{word}</span> '
        f'<b>{text}</b> <i aria-hidden="true">{mark}</i>'
        f'<em class="unseen">, {standing}</em></summary>'
        f"<div>{html.escape(one.reason)} "
        f"{leading(f'Show {tab}', lead)}</div></details>"
    )
