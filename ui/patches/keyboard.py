"""Names and keys of what viser leaves to the mouse and the eye, for keyboards and screen readers.

viser ties no label to the thumb of a slider or to a box, its images have no words, titles of
folders and some of its own buttons take no focus, and the edge of a dock can only be dragged. The
page is looked through whenever something has come into it, and given what lacks:

- thumbs, boxes, images and buttons of an icon get the name that stands beside them;
- titles of folders, and whatever is called a button, take the focus; Enter and space click;
- the edge of a dock is a separator: arrows move it, by a drag of the page's own;
- arrows on a slider, a tab or such an edge are theirs: viser turns the eye by them as well.
"""

from __future__ import annotations

ICONS = {
    "list-search": "Find a command",
    "adjustments": "Settings of the view",
    "adjustments-horizontal": "Settings of the view",
    "tool": "Settings of the view",
    "arrow-back": "Back to the pages",
    "maximize": "Expand image",
}
"""What viser's buttons of an icon alone do, by the icon's name."""
STEP_PX = 20
"""How far an arrow moves the edge of a dock."""
PAUSE_MS = 250
"""Between a change of the page and the look through it: a frame that plays changes it often."""
MEND = """
(() => {
  const before = window.namedPage;
  if (before) {
    before.watch.disconnect();
    document.removeEventListener('keydown', before.key, true);
    document.body.removeEventListener('keydown', before.arrow);
  }
  const icons = ICONS;
  const put = (node, name, value) => {
    if (node.getAttribute(name) !== value) node.setAttribute(name, value);
  };
  const named = node => node.getAttribute('aria-label') || node.getAttribute('aria-labelledby')
    || node.getAttribute('title') || (node.id && node.tagName === 'INPUT'
      && document.querySelector(`label[for="${CSS.escape(node.id)}"]`));
  const boxes = 'input:not([type=hidden]):not([type=file]), textarea, [role=slider]';
  const labels = () => {
    for (const label of document.querySelectorAll('label[for]')) {
      const words = label.textContent.trim();
      if (!words) continue;
      let around = document.getElementById(label.htmlFor) || label;
      /* A slider's box stands beside it; text and vectors carry no id. */
      for (let up = 0; up < 4 && around && !around.contains(label); up++)
        around = around.parentElement;
      for (let up = 0; up < 4 && around && !around.querySelector(boxes); up++)
        around = around.parentElement;
      if (!around || around.querySelectorAll('label[for]').length > 1) continue;
      const found = [...around.querySelectorAll(boxes)];
      const typed = found.filter(node => node.tagName === 'INPUT');
      for (const node of found) {
        if (named(node)) continue;
        const axis = typed.length > 1 ? ' ' + 'xyz'[typed.indexOf(node)] : '';
        put(node, 'aria-label', words + axis);
      }
    }
  };
  const images = () => {
    for (const image of document.querySelectorAll('img[src^="blob:"]:not([alt])')) {
      const group = image.closest('[data-dock-group], .mantine-Tabs-root');
      const tab = group && group.querySelector('[role=tab][aria-selected=true]');
      const words = image.parentElement.previousElementSibling;
      put(image, 'alt', (words && words.textContent.trim())
        || (tab ? `${tab.textContent.trim()}, picture` : 'picture'));
    }
  };
  const buttons = () => {
    for (const node of document.querySelectorAll('button')) {
      if (named(node) || node.textContent.trim() || node.querySelector('img[alt]')) continue;
      const icon = node.querySelector('[class*=tabler-icon-]');
      const kind = icon && /tabler-icon-([a-z-]+)/.exec(icon.getAttribute('class'));
      const note = node.closest('.mantine-Notification-root');
      put(node, 'aria-label', note ? 'Close notification'
        : kind ? icons[kind[1]] || kind[1].replaceAll('-', ' ') : 'Button');
    }
    for (const node of document.querySelectorAll('[role=button]:not([tabindex])'))
      put(node, 'tabindex', '0');
  };
  const folds = () => {
    for (const title of document.querySelectorAll('.mantine-Paper-root > .mantine-Paper-root')) {
      const icon = title.querySelector(':scope > [class*=tabler-icon-chevron]');
      if (!icon || icon.style.display === 'none') continue;
      put(title, 'role', 'button');
      put(title, 'tabindex', '0');
      put(title, 'data-title', '1');
      put(title, 'aria-expanded', String(icon.classList.contains('tabler-icon-chevron-up')));
    }
  };
  const edges = () => {
    for (const edge of document.querySelectorAll('[data-dock-region-resize]')) {
      const side = edge.dataset.dockRegionResize;
      const region = document.querySelector(`[data-dock-region="${side}"]`);
      put(edge, 'role', 'separator');
      put(edge, 'tabindex', '0');
      put(edge, 'aria-orientation', 'vertical');
      put(edge, 'aria-label', `Width of the ${side} dock`);
      put(edge, 'aria-valuemin', '100');
      put(edge, 'aria-valuemax', String(innerWidth));
      if (region) put(edge, 'aria-valuenow', String(Math.round(region.offsetWidth)));
    }
  };
  const look = () => {
    for (const part of [labels, images, buttons, folds, edges]) part();
  };
  let soon = 0;
  const watch = new MutationObserver(() => {
    if (!soon) soon = setTimeout(() => { soon = 0; look(); }, PAUSE);
  });
  watch.observe(document.body, {childList: true, subtree: true});
  window.dragEdge = (edge, px) => {
    const send = (name, where, x) => where.dispatchEvent(new PointerEvent(name,
      {bubbles: true, button: 0, pointerId: 77, pointerType: 'mouse', clientX: x, clientY: 300}));
    const strip = edge.firstElementChild;
    send('pointerdown', strip, 500);
    send('pointermove', window, 500 + px);
    send('pointerup', window, 500 + px);
  };
  const key = event => {
    const node = event.target;
    if (!node.getAttribute || event.ctrlKey || event.altKey || event.metaKey) return;
    if (node.dataset.dockRegionResize) {
      const way = {ArrowLeft: -STEP, ArrowRight: STEP}[event.key];
      if (!way) return;
      event.preventDefault();
      window.dragEdge(node, way);
      return;
    }
    if (event.key !== 'Enter' && event.key !== ' ') return;
    const bare = node.getAttribute('role') === 'button' && node.tagName !== 'BUTTON';
    if (!bare || !(node.dataset.title || /^Collapse panel/.test(node.ariaLabel || ''))) return;
    if (node.hasAttribute('aria-expanded') && !node.dataset.title) return;
    event.preventDefault();
    event.stopPropagation();
    node.click();
    setTimeout(look, PAUSE);
  };
  document.addEventListener('keydown', key, true);
  /* After the widget, before the document, where viser turns the eye by any arrow. */
  const arrow = event => {
    if (event.key.startsWith('Arrow') && event.target.closest('[role=slider], [role=tab], '
      + '[role=separator]')) event.stopPropagation();
  };
  document.body.addEventListener('keydown', arrow);
  window.namedPage = {watch, key, arrow};
  look();
})();
"""
SHEET = """
/* Where the keyboard is: viser shows it on some of its parts only. */
:is(button, input, textarea, summary, a, [tabindex]):focus-visible,
.mantine-Slider-thumb:focus-visible, .mantine-Slider-thumb:focus {
  outline: 2px solid var(--mantine-primary-color-light-color) !important;
  outline-offset: 1px;
}
[role="tab"]:focus-visible, [data-dock-region-resize]:focus-visible {
  outline-offset: -3px !important;
}
"""


def mend_keyboard() -> str:
    """The script, in place of one of an earlier page of the same server."""
    import json

    script = MEND.replace("ICONS", json.dumps(ICONS))
    return script.replace("STEP", str(STEP_PX)).replace("PAUSE", str(PAUSE_MS))
