"""A line drawn on an image by the mouse: its ends fill four sliders' boxes.

As `image_click`, whose way of typing into boxes it shares: pressed on the image, pulled, let go.
"""

from __future__ import annotations

from ui.patches.image_click import TYPE_INTO_BOXES, hidden_mark

TARGET = "line-image"
"""Class of the piece of HTML; its parents are searched for images and boxes."""
INSTALL = (
    TYPE_INTO_BOXES
    + """
for (const [name, handler] of Object.entries(window.lineImage || {}))
  document.removeEventListener(name, handler, true);
const marked = event => {
  if (event.target.tagName !== 'IMG' || !event.target.src.startsWith('blob:')) return null;
  for (const mark of document.querySelectorAll('.line-image')) {
    let tab = mark;
    while (tab && !tab.querySelector('img[src^="blob:"]')) tab = tab.parentElement;
    if (tab && tab.contains(event.target)) return [mark, tab];
  }
  return null;
};
let begun = null;
window.lineImage = {
  dragstart: event => { if (marked(event)) event.preventDefault(); },
  pointerdown: event => {
    const found = marked(event);
    begun = found && {found, image: event.target, x: event.clientX, y: event.clientY};
  },
  pointerup: event => {
    if (!begun) return;
    const [mark, tab] = begun.found;
    const box = begun.image.getBoundingClientRect();
    const across = x => (x - box.left) / box.width, down = y => (y - box.top) / box.height;
    window.typeIntoBoxes(tab, {
      [mark.dataset.column]: across(begun.x), [mark.dataset.row]: down(begun.y),
      [mark.dataset.tocolumn]: across(event.clientX), [mark.dataset.torow]: down(event.clientY),
    });
    begun = null;
  },
};
for (const [name, handler] of Object.entries(window.lineImage))
  document.addEventListener(name, handler, true);
"""
)
"""Installs the handlers, in place of those of an earlier page of the same server."""


def image_lines(*, start: tuple[str, str], stop: tuple[str, str]) -> str:
    """What stands before the image, as HTML.

    Args:
        start: Labels of the sliders of the column and the row where a line begins.
        stop: The same of where it ends.
    """
    names = zip(("column", "row", "tocolumn", "torow"), (*start, *stop), strict=True)
    return hidden_mark(TARGET, INSTALL, dict(names))
