"""Buttons in HTML that lead to where something is done: a tab, a folder, a key, another button.

viser can neither choose a tab nor open a folder, its tabs take no clicks of a script, and a button
of its own cannot stand in a tab twice. One handler of the page serves all that carry the data:

- `data-goto`, a tab's label: Enter is pressed on it;
- `data-fold`, with it: the folder of that label is opened and glows;
- `data-press`: the button of that text, in a tab that is open or goes open, is pressed;
- `data-key`: the command of that letter runs, as if it were typed.

What opens over the page, as the reason of a figure does, closes by Escape or a press elsewhere.
"""

from __future__ import annotations

import html
from collections.abc import Mapping

LEAD = """
document.removeEventListener('click', window.leadThere, true);
window.leadThere = event => {
  const from = event.target.closest &&
    event.target.closest('[data-goto], [data-press], [data-key]');
  if (!from) return;
  const {goto, fold, press, key} = from.dataset;
  const named = (kind, text) =>
    [...document.querySelectorAll(kind)].find(one => one.textContent.trim() === text);
  if (key) document.documentElement.dispatchEvent(new KeyboardEvent('keydown',
    {key, code: 'Key' + key.toUpperCase(), bubbles: true}));
  const push = () => {
    const button = press && named('button', press);
    if (button) button.click();
  };
  const tab = goto && named('[role=tab]', goto);
  if (tab) tab.dispatchEvent(new KeyboardEvent('keydown', {key: 'Enter', bubbles: true}));
  const open = from.closest('details');
  if (open) open.open = false;
  /* A tab's widgets are laid out after it is chosen. */
  if (tab) setTimeout(push, 500); else push();
  if (fold) setTimeout(() => {
    const title = named('.mantine-Paper-root > .mantine-Paper-root', fold);
    if (!title) return;
    if (title.querySelector('.tabler-icon-chevron-down')) title.click();
    title.scrollIntoView({block: 'start'});
    title.parentElement.animate(
      [{boxShadow: '0 0 0 2px #f5a623'}, {boxShadow: '0 0 0 2px #f5a62300'}],
      {duration: 1200, iterations: 3});
  }, 500);
};
document.addEventListener('click', window.leadThere, true);

for (const kind of ['pointerdown', 'keydown'])
  document.removeEventListener(kind, window.closeReasons, true);
window.closeReasons = event => {
  if (event.type === 'keydown' && event.key !== 'Escape') return;
  for (const open of document.querySelectorAll('details[name][open]'))
    if (event.type === 'keydown' || !open.contains(event.target)) open.open = false;
};
for (const kind of ['pointerdown', 'keydown'])
  document.addEventListener(kind, window.closeReasons, true);
"""
"""Installs the handler, in place of that of an earlier page of the same server."""
SHEET = """
/* What stands where there is nothing yet: a sentence and a button that does it. */
.empty-state { margin: 6px 10px; font-size: 13px; line-height: 1.45;
  color: var(--mantine-color-text); }
.empty-state button, .home { border: 1px solid var(--mantine-primary-color-light-color);
  border-radius: 4px; padding: 3px 10px; background: none; cursor: pointer; font: inherit;
  color: var(--mantine-color-text); }
.empty-state button { display: block; margin-top: 6px; }
.design-title { margin: 0 10px; font-size: 14px; color: var(--mantine-color-text);
  display: flex; gap: 8px; align-items: baseline; }
.design-title > span { overflow: hidden; text-overflow: ellipsis; }
.home { font-size: 12px; padding: 1px 8px; flex-shrink: 0; }
"""


def leading(words: str, data: Mapping[str, str], *, kind: str = "") -> str:
    """A button in HTML.

    Args:
        words: What it says.
        data: `goto`, `fold`, `press` or `key`.
        kind: Its class.
    """
    told = "".join(f' data-{name}="{html.escape(value)}"' for name, value in data.items())
    look = f' class="{kind}"' if kind else ""
    return f'<button type="button"{look}{told}>{html.escape(words)}</button>'


def empty_state(words: str, button: str = "", **data: str) -> str:
    """What stands where there is nothing yet, as HTML: a sentence, and a button that does it."""
    return f'<div class="empty-state">{html.escape(words)}{leading(button, data)}</div>'
