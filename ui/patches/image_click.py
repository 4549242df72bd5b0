"""Clicks on an image, which viser's images do not have: they fill the pixel's boxes.

A piece of HTML beside the image installs one handler in the page. It turns the place of a click
into a column and a row of the camera and types both into the sliders' boxes, so that all else goes
the way of typed values: a tab that follows is refused, and the server knows of no second way. The
sliders' ends tell the camera's size, whatever the image's own size and however large it is shown.

Where the place under the mouse is wanted, a mouse that rests over the 3D view is told by a click of
the page's own there, with keys held by which `ui.scene.pointing` knows it.
"""

from __future__ import annotations

import html
from collections.abc import Mapping

COLUMN, ROW = "Pixel column px", "Pixel row px"
"""Labels of the sliders that a click on the tactile image fills."""
PIXEL_GIF = "data:image/gif;base64,R0lGODlhAQABAIAAAAAAAP///yH5BAEAAAAALAAAAAABAAEAAAIBRAA7"
"""An image that loads at once, by which the page runs the handler's script."""
PAUSE_MS = 60
"""A place under the mouse is told once the mouse has rested so long: each is drawn in 3D [ms]."""
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
document.removeEventListener('pointermove', window.probeUnder, true);
window.probeAt = (event, hovered) => {
  const image = event.target;
  if (image.tagName !== 'IMG' || !image.src.startsWith('blob:')) return;
  if (window.imageMoved || event.buttons) return;
  for (const mark of document.querySelectorAll('.probe-image')) {
    let tab = mark;
    while (tab && !tab.querySelector('img[src^="blob:"]')) tab = tab.parentElement;
    const whole = image.closest('.whole-image') && tab && tab.querySelector('.zoom-image');
    if (!tab || !(whole || tab.contains(image))) continue;
    if (hovered && !mark.dataset.hover) continue;
    const box = image.getBoundingClientRect();
    event.stopPropagation();
    window.typeIntoBoxes(tab, {
      [mark.dataset.column]: (event.clientX - box.left) / box.width,
      [mark.dataset.row]: (event.clientY - box.top) / box.height,
    });
    return;
  }
};
window.probeImage = event => window.probeAt(event, false);
window.clickForTheMouse = event => {
  if (!document.querySelector('.probe-image[data-hover]') || event.buttons) return;
  const keys = {ctrlKey: true, altKey: true, shiftKey: true};
  for (const name of ['pointerdown', 'pointerup'])
    event.target.dispatchEvent(new PointerEvent(name, {...keys, bubbles: true, button: 0,
      pointerId: event.pointerId, pointerType: 'mouse', isPrimary: true,
      clientX: event.clientX, clientY: event.clientY}));
};
window.probeUnder = event => {
  clearTimeout(window.probeSoon);
  if (!event.isTrusted) return;
  const scene = event.target.tagName === 'CANVAS' && event.target.dataset.engine;
  window.probeSoon = setTimeout(
    () => scene ? window.clickForTheMouse(event) : window.probeAt(event, true), PAUSE);
};
document.addEventListener('click', window.probeImage, true);
document.addEventListener('pointermove', window.probeUnder, true);
"""
).replace("PAUSE", str(PAUSE_MS))
"""Installs the handler, in place of one of an earlier page of the same server."""
CROSSHAIR = '<style>div:has(> .{0}) ~ div img[src^="blob:"]{{cursor:crosshair}}</style>'


def image_clicks(on: bool, *, hover: bool = False, column: str = COLUMN, row: str = ROW) -> str:
    """What stands before the images, as HTML: the handler where clicks are wanted, or nothing.

    Args:
        on: Whether clicks are wanted.
        hover: Whether the place under the mouse is wanted too, without a click.
        column: Label of the slider of columns that a click fills.
        row: The same of rows.
    """
    labels = {"column": column, "row": row} | ({"hover": "1"} if hover else {})
    return hidden_mark(TARGET, INSTALL, labels) if on or hover else ""


def hidden_mark(
    target: str,
    install: str,
    labels: Mapping[str, str],
    *,
    inside: str = "",
    crosshair: bool = True,
) -> str:
    """A piece of HTML that installs a script, and tells it labels of sliders.

    Args:
        target: Its class.
        install: The script.
        labels: By the names of its data.
        inside: What is seen of it, HTML.
        crosshair: Whether images after it get a crosshair.
    """
    data = " ".join(f'data-{name}="{html.escape(label)}"' for name, label in labels.items())
    cross = CROSSHAIR.format(target) if crosshair else ""
    return f'<div class="{target}" {data}>{cross}{inside}{script_in_html(install)}</div>'


def script_in_html(script: str) -> str:
    """HTML that is not seen and runs a script once it stands in the page.

    A page runs no script tag that is put into it later, but an image that loads.
    """
    written = html.escape(" ".join(script.split()), quote=True)
    return f'<img alt="" style="display:none" src="{PIXEL_GIF}" onload="{written}">'
