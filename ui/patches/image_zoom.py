"""Zoom, pan and the whole page for a tab's images, which viser's images do not have.

A piece of HTML before the images installs handlers in the page, as `image_click` does. All images
of one size in a tab are looked at alike, so that an image and its change show the same place. Only
CSS changes: nothing is sent, a tab that follows may look as it likes, and a click still finds its
pixel, since its place is told from the image as it is drawn.

Filling the page puts one more image over the docks, below floating bars, so that the timeline
stands under it; the 3D view, which draws itself for the room it has, stands in a corner meanwhile.
The image takes each new picture of the tab's first image as soon as that is loaded.
"""

from __future__ import annotations

from collections.abc import Mapping

from ui.patches.image_click import TYPE_INTO_BOXES, hidden_mark

TAB = "Tactile image"
"""Label of the tab that has the images."""
TARGET = "zoom-image"
"""Class of the piece of HTML; its parents are searched for images and boxes."""
MOST_TIMES = 16
"""Further in, a pixel of the camera is larger than a thumb."""
STEP = 1.25
BAR_PX = 190
"""Height that the timeline's bar, narrow and so higher, takes below an image over the page."""
INSTALL = (
    TYPE_INTO_BOXES
    + """
for (const [name, handler] of Object.entries((window.imageZoom || {}).handlers || {}))
  document.removeEventListener(name, handler, {capture: true});
(() => {
  const at = {times: 1, x: 0, y: 0};
  let page = null, drag = null, down = {ms: -1e9, x: 0, y: 0};
  const tab = () => {
    for (const mark of document.querySelectorAll('.zoom-image')) {
      let around = mark;
      while (around && !around.querySelector('img[src^="blob:"]')) around = around.parentElement;
      if (around) return [around, mark];
    }
    return [null, null];
  };
  const images = () => {
    const [around] = tab();
    const found = around ? [...around.querySelectorAll('img[src^="blob:"]')] : [];
    const first = found[0];
    const alike = found.filter(image => image.naturalWidth === first.naturalWidth
      && image.naturalHeight === first.naturalHeight);
    return page ? [...alike, page.image] : alike;
  };
  const draw = () => {
    at.times = Math.min(MOST, Math.max(1, at.times));
    at.x = Math.min(0, Math.max(1 - at.times, at.x));
    at.y = Math.min(0, Math.max(1 - at.times, at.y));
    for (const image of images()) {
      image.parentElement.style.overflow = 'hidden';
      image.style.transformOrigin = '0 0';
      image.style.transform =
        `translate(${100 * at.x}%, ${100 * at.y}%) scale(${at.times})`;
      image.style.imageRendering = at.times > 4 ? 'pixelated' : 'auto';
      image.style.cursor = at.times > 1 ? 'grab' : '';
    }
  };
  const about = (times, x, y) => {
    const next = Math.min(MOST, Math.max(1, times));
    at.x = x - next / at.times * (x - at.x);
    at.y = y - next / at.times * (y - at.y);
    at.times = next;
    draw();
  };
  const shares = (image, event) => {
    const box = image.parentElement.getBoundingClientRect();
    return [(event.clientX - box.left) / box.width, (event.clientY - box.top) / box.height];
  };
  /* An image whose next picture is still loading has no size; it is known by how it is drawn. */
  const of = event => event.target.tagName === 'IMG'
    && (event.target.style.transform || images().includes(event.target)) ? event.target : null;
  const scene = () => {
    const canvas = document.querySelector('canvas[data-engine]');
    return canvas && canvas.closest('[style*="z-index: 0"]');
  };
  const close = () => {
    if (!page) return;
    page.whole.remove();
    page = null;
    if (scene()) scene().classList.remove('scene-in-the-corner');
  };
  const fit = () => {
    if (!page) return;
    const ratio = page.image.naturalWidth / page.image.naturalHeight || 4 / 3;
    const [wide, high] = [innerWidth - 16, innerHeight - BAR - 56];
    page.frame.style.width = `${Math.min(wide, high * ratio)}px`;
  };
  const open = () => {
    const [around, mark] = tab();
    if (!around || page) return;
    let root = document.querySelector('canvas');
    while (root && !root.contains(mark)) root = root.parentElement;
    const whole = document.createElement('div');
    whole.className = 'whole-image';
    whole.innerHTML = '<div class="image-tools"><label>Rest on the left <input type="range" min="0"'
      + ' max="100" value="0"></label></div><div class="whole-frame"><img alt="tactile image">'
      + '</div>';
    const tools = mark.querySelector('.image-tools').cloneNode(true);
    tools.querySelector('[data-act=page]').textContent = 'Close (Esc)';
    whole.firstChild.prepend(...tools.childNodes);
    (root || document.body).append(whole);
    if (scene()) scene().classList.add('scene-in-the-corner');
    page = {whole, frame: whole.lastChild, image: whole.querySelector('img')};
    page.image.src = around.querySelector('img[src^="blob:"]').src;
    const wipe = whole.querySelector('input');
    const now = [...around.querySelectorAll('label[for]')]
      .find(label => label.textContent.trim() === mark.dataset.wipe);
    const slider = now && document.getElementById(now.htmlFor);
    if (slider) wipe.value = slider.querySelector('[role=slider]').getAttribute('aria-valuenow');
    wipe.oninput = () =>
      window.typeIntoBoxes(around, {[mark.dataset.wipe]: wipe.value / 101 + 1e-6});
    draw();
  };
  const acts = {
    out: () => about(at.times / STEP, 0.5, 0.5), in: () => about(at.times * STEP, 0.5, 0.5),
    all: () => about(1, 0, 0), page: () => {
      if (page) return close();
      const [around] = tab();
      const first = around && around.querySelector('img[src^="blob:"]');
      if (first && first.offsetParent) return open();
      /* In a tab that is not chosen images are not there, or no longer hold a picture. */
      for (const one of document.querySelectorAll('[role=tab]'))
        if (one.textContent.trim() === 'NAMED')
          one.dispatchEvent(new KeyboardEvent('keydown', {key: 'Enter', bubbles: true}));
      setTimeout(open, 700);
    },
  };
  window.imageZoom = {acts, handlers: {
    load: event => {
      if (!of(event)) return;
      const [around] = tab();
      if (page && event.target === around.querySelector('img[src^="blob:"]'))
        page.image.src = event.target.src;
      fit();
      draw();
    },
    wheel: event => {
      const image = of(event);
      if (!image || !(event.ctrlKey || at.times > 1 || (page && image === page.image))) return;
      event.preventDefault();
      event.stopPropagation();
      about(at.times * (event.deltaY < 0 ? STEP : 1 / STEP), ...shares(image, event));
    },
    pointerdown: event => {
      const image = of(event);
      window.imageMoved = false;
      /* Not dblclick: an image that a click has drawn anew is another element by the second one. */
      const near = Math.hypot(event.clientX - down.x, event.clientY - down.y) < 6;
      const twice = image && near && event.timeStamp - down.ms < 350;
      down = twice ? {ms: -1e9, x: 0, y: 0}
        : {ms: event.timeStamp, x: event.clientX, y: event.clientY};
      if (twice) return acts[at.times > 1 ? 'all' : 'page']();
      if (image && at.times > 1)
        drag = {image, from: shares(image, event), x: at.x, y: at.y};
    },
    pointermove: event => {
      if (!drag) return;
      const [x, y] = shares(drag.image, event);
      const way = [x - drag.from[0], y - drag.from[1]];
      if (Math.hypot(...way) > 0.01) window.imageMoved = true;
      [at.x, at.y] = [drag.x + way[0], drag.y + way[1]];
      draw();
    },
    pointerup: () => { drag = null; },
    dragstart: event => { if (of(event)) event.preventDefault(); },
    click: event => {
      const tool = event.target.closest && event.target.closest('.image-tools [data-act]');
      if (tool) acts[tool.dataset.act]();
    },
    keydown: event => { if (event.key === 'Escape') close(); },
    resize: fit,
  }};
  for (const [name, handler] of Object.entries(window.imageZoom.handlers))
    (name === 'resize' ? window : document)
      .addEventListener(name, handler, {capture: true, passive: false});
})();
"""
)
"""Installs the handlers, in place of those of an earlier page of the same server."""
TOOLS: Mapping[str, tuple[str, str]] = {
    "out": ("−", "Zoom out"),
    "in": ("+", "Zoom in (Ctrl and the wheel); a drag then moves the image"),
    "all": ("Whole image", "Show the whole image again (double click)"),
    "page": ("Fill the page", "Show the image as large as the page (W, or a double click)"),
}
"""What a row of small buttons above the images does: words and hints."""


def image_zoom(*, wipe: str) -> str:
    """What stands before the images, as HTML.

    Args:
        wipe: Label of the slider that has the untouched skin on the left.
    """
    install = (
        INSTALL.replace("MOST", str(MOST_TIMES))
        .replace("STEP", str(STEP))
        .replace("BAR", str(BAR_PX))
        .replace("NAMED", TAB)
    )
    tools = "".join(
        f'<button type="button" data-act="{act}"{"" if text[1:] else label} {title}>{text}</button>'
        for act, (text, hint) in TOOLS.items()
        for label, title in ((f' aria-label="{hint}"', f'title="{hint}"'),)
    )
    row = f'<div class="image-tools">{tools}</div>'
    return hidden_mark(TARGET, install, {"wipe": wipe}, inside=row, crosshair=False)


FILL_PAGE = "window.imageZoom && window.imageZoom.acts.page()"
"""Fills the page with the image, or ends it."""
