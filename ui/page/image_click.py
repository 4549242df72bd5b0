"""Clicks on an image, which viser's images do not have: they fill the pixel's boxes.

A piece of HTML beside the image installs one handler in the page. It turns the place of a click
into a column and a row of the camera and types both into the sliders' boxes, so that all else goes
the way of typed values: a tab that follows is refused, and the server knows of no second way. The
sliders' ends tell the camera's size, whatever the image's own size and however large it is shown.
"""

from __future__ import annotations

import html
from collections.abc import Mapping

COLUMN, ROW = "Pixel column px", "Pixel row px"
"""Labels of the sliders that a click on the tactile image fills."""
PIXEL_GIF = "data:image/gif;base64,R0lGODlhAQABAIAAAAAAAP///yH5BAEAAAAALAAAAAABAAEAAAIBRAA7"
"""An image that loads at once, by which the page runs the handler's script."""
TARGET = "probe-image"
"""Class of the piece of HTML; its parents are searched for images and boxes."""
TYPE_INTO_BOXES = """
window.typeIntoBoxes = (tab, shares) => {
  for (const label of tab.querySelectorAll('label[for]')) {
    const slider = document.getElementById(label.htmlFor);
    const share = shares[label.innerText.trim() || label.textContent.trim()];
    if (share === undefined || !slider) continue;
    const most = Number(slider.querySelector('[role=slider]').getAttribute('aria-valuemax'));
    const input = slider.parentElement.querySelector('input:not([type=hidden])');
    const value = Math.min(most, Math.max(0, Math.floor(share * (most + 1))));
    const own = Object.getOwnPropertyDescriptor(HTMLInputElement.prototype, 'value');
    own.set.call(input, String(value));
    input.dispatchEvent(new Event('input', {bubbles: true}));
    input.dispatchEvent(new Event('focusout', {bubbles: true}));
  }
};
"""
"""Types shares of an image's width and height into the boxes of sliders by their labels."""
INSTALL = (
    TYPE_INTO_BOXES
    + """
document.removeEventListener('click', window.probeImage, true);
window.probeImage = event => {
  if (event.target.tagName !== 'IMG' || !event.target.src.startsWith('blob:')) return;
  for (const mark of document.querySelectorAll('.probe-image')) {
    let tab = mark;
    while (tab && !tab.querySelector('img[src^="blob:"]')) tab = tab.parentElement;
    if (!tab || !tab.contains(event.target)) continue;
    const box = event.target.getBoundingClientRect();
    event.stopPropagation();
    window.typeIntoBoxes(tab, {
      [mark.dataset.column]: (event.clientX - box.left) / box.width,
      [mark.dataset.row]: (event.clientY - box.top) / box.height,
    });
    return;
  }
};
document.addEventListener('click', window.probeImage, true);
"""
)
"""Installs the handler, in place of one of an earlier page of the same server."""
CROSSHAIR = '<style>div:has(> .{0}) ~ div img[src^="blob:"]{{cursor:crosshair}}</style>'


def image_clicks(on: bool, *, column: str = COLUMN, row: str = ROW) -> str:
    """What stands before the images, as HTML: the handler where clicks are wanted, or nothing.

    Args:
        on: Whether clicks are wanted.
        column: Label of the slider of columns that a click fills.
        row: The same of rows.
    """
    return hidden_mark(TARGET, INSTALL, {"column": column, "row": row}) if on else ""


def hidden_mark(target: str, install: str, labels: Mapping[str, str]) -> str:
    """A piece of HTML that is not seen, installs a script, and tells it labels of sliders.

    Args:
        target: Its class; images after it get a crosshair.
        install: The script.
        labels: By the names of its data.
    """
    script = html.escape(" ".join(install.split()), quote=True)
    loads = f'<img alt="" style="display:none" src="{PIXEL_GIF}" onload="{script}">'
    data = " ".join(f'data-{name}="{html.escape(label)}"' for name, label in labels.items())
    return f'<div class="{target}" {data}>{CROSSHAIR.format(target)}{loads}</div>'
