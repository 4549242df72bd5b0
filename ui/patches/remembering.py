"""What a browser remembers of the page: widths of both docks, and which tabs were open.

viser tells the server neither, and forgets both at a reload. The page keeps them itself in
`localStorage`, once something was dragged or chosen, and puts them back once the docks stand: a
width by a drag of the edge as the keyboard does it (`keyboard.py`), a tab by Enter. A width is put
back as far as the timeline finds room between the docks; of tabs none, once a hand has chosen one
before the docks stood. All of it happens once in a page.

*Image size* is the width of the right dock, so it is remembered with that. Where a dock was moved
to, or whether it is minimised, is not.
"""

from __future__ import annotations

STORED = "workbench-docks"
ROOM_PX = 545
"""What is left between the docks: the timeline with its margins."""
STAND_MS = 400
"""Docks that have not changed for so long stand."""
NARROW_PX = 576
"""Narrower pages have one sheet in place of docks."""
REMEMBER = """
(() => {
  const before = window.keptDocks;
  if (before) {
    /* The page lays this script several times while its docks come. */
    clearTimeout(before.waits);
    for (const name of ['pointerup', 'keyup'])
      document.removeEventListener(name, before.later, true);
  }
  const regions = () => Object.fromEntries(['left', 'right'].map(side => {
    const found = document.querySelector(`[data-dock-region="${side}"]`);
    return [side, found ? Math.round(found.getBoundingClientRect().width) : 0];
  }));
  const tabs = () => [...document.querySelectorAll('[role=tab]')];
  const open = () => tabs().filter(tab => tab.getAttribute('aria-selected') === 'true')
    .map(tab => tab.textContent.trim());
  const read = () => {
    try { return JSON.parse(localStorage.getItem('STORED')) || {}; } catch { return {}; }
  };
  const keep = () => {
    if (innerWidth <= NARROW || !window.keptDocks.back) return;
    const kept = JSON.stringify({...regions(), tabs: open()});
    try { localStorage.setItem('STORED', kept); } catch { /* A browser that keeps nothing. */ }
  };
  const put = () => {
    const kept = read(), now = regions();
    for (const side of ['left', 'right']) {
      const other = side === 'left' ? regions().right : regions().left;
      const most = innerWidth - other - ROOM;
      const wanted = Math.min(kept[side] || 0, Math.max(most, now[side]));
      const edge = document.querySelector(`[data-dock-region-resize="${side}"]`);
      const more = wanted - now[side];
      if (kept[side] > 100 && Math.abs(more) > 2 && edge && window.dragEdge)
        window.dragEdge(edge, side === 'left' ? more : -more);
    }
    for (const name of window.keptDocks.chosen ? [] : kept.tabs || []) {
      const tab = tabs().find(one => one.textContent.trim() === name);
      if (tab && tab.getAttribute('aria-selected') !== 'true')
        tab.dispatchEvent(new KeyboardEvent('keydown', {key: 'Enter', bubbles: true}));
    }
    window.keptDocks.back = true;
    if (window.keptDocks.chosen) keep();
  };
  let last = '', stood = 0;
  const wait = () => {
    const now = JSON.stringify(regions());
    stood = now === last && regions().left && regions().right ? stood + 1 : 0;
    last = now;
    if (stood >= 2) put(); else window.keptDocks.waits = setTimeout(wait, STAND);
  };
  let soon = 0;
  const later = event => {
    const pushed = event.type === 'pointerup' || event.key === 'Enter' || event.key === ' ';
    if (event.isTrusted && pushed && event.target.closest && event.target.closest('[role=tab]'))
      window.keptDocks.chosen = true;
    clearTimeout(soon); soon = setTimeout(keep, 800);
  };
  for (const name of ['pointerup', 'keyup']) document.addEventListener(name, later, true);
  const {back = false, chosen = false} = before || {};
  window.keptDocks = {later, back, chosen};
  if (innerWidth > NARROW && !window.keptDocks.back) wait();
})();
"""


def remember() -> str:
    """The script, in place of one of an earlier page of the same server."""
    script = REMEMBER.replace("STORED", STORED).replace("ROOM", str(ROOM_PX))
    return script.replace("STAND", str(STAND_MS)).replace("NARROW", str(NARROW_PX))
