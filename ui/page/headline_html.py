"""The headline as HTML: a row of figures, each of which opens its reason and leads to its page.

A mark of its own shape stands beside the colour, so that hue is never the only carrier. The reason
opens below the row; what leads to a page presses Enter on its tab, since viser's tabs take no
clicks of a script.
"""

from __future__ import annotations

import html
from collections.abc import Sequence

from ui.patches.image_click import script_in_html
from workbench.view.headline import Shown, Standing

MARKS = {
    Standing.GOOD: ("●", "good"),
    Standing.FAIR: ("▲", "fair"),
    Standing.POOR: ("■", "poor"),
    Standing.PLAIN: ("", "plain"),
    Standing.OPEN: ("○", "open"),
}
"""Shape and class of each standing."""
GO_TO_TAB = """
document.removeEventListener('click', window.goToTab, true);
window.goToTab = event => {
  const button = event.target.closest && event.target.closest('[data-goto]');
  if (!button) return;
  for (const tab of document.querySelectorAll('[role=tab]'))
    if (tab.textContent.trim() === button.dataset.goto)
      tab.dispatchEvent(new KeyboardEvent('keydown', {key: 'Enter', bubbles: true}));
  const open = button.closest('details');
  if (open) open.open = false;
};
document.addEventListener('click', window.goToTab, true);
"""


def headline_html(shown: Sequence[Shown]) -> str:
    """The row; what is of the design before the last edits stands faded, in brackets."""
    chips = "".join(_chip(one) for one in shown)
    return f'<div class="headline">{chips}{script_in_html(GO_TO_TAB)}</div>'


def _chip(one: Shown) -> str:
    mark, kind = MARKS[one.standing]
    kind = f"{kind} old" if one.old else kind
    word, tab = html.escape(one.headline.word), html.escape(one.headline.tab)
    text = html.escape(f"({one.text})" if one.old else one.text)
    name = f"{word}: {text}, {one.standing.value}"
    return (
        f'<details name="headline" class="{kind}">'
        f'<summary aria-label="{name}" title="{name}"><span>{word}</span>'
        f"<b>{text}</b><i>{mark}</i></summary>"
        f"<div>{html.escape(one.reason)} "
        f'<button type="button" data-goto="{tab}">Show {tab}</button></div></details>'
    )
