"""The note that a browser draws without its graphics card goes by itself once it has been read.

viser shows it at every load until it is closed by hand, over the upper left of the 3D view, where
on a small page the sensor and its dimensions stand. It comes while the page is laid out, or before.
"""

from __future__ import annotations

TITLE = "Software WebGL rendering detected"
READ_MS = 8_000
"""Time to read its forty words."""
LATEST_MS = 60_000
"""Where it has not come by then, the browser has a graphics card."""
CLOSE = """
clearInterval(window.softwareNote);
(() => {
  const begin = performance.now();
  let seen = 0;
  window.softwareNote = setInterval(() => {
    const now = performance.now();
    const note = [...document.querySelectorAll('.mantine-Notification-root')]
      .find(one => one.textContent.includes('TITLE'));
    seen = note ? seen || now : 0;
    /* Whoever reads longer holds the mouse over it. */
    if (note && now - seen > READ && !note.matches(':hover')) note.querySelector('button').click();
    if (!note && now - begin > LATEST) clearInterval(window.softwareNote);
  }, 1000);
})();
"""


def close_software_note() -> str:
    """The script, in place of that of an earlier page of the same server."""
    script = CLOSE.replace("TITLE", TITLE)
    return script.replace("READ", str(READ_MS)).replace("LATEST", str(LATEST_MS))
