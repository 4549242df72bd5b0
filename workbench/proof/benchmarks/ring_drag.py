"""How soon the image's preview follows a drag of the LED ring, in headless Chromium."""

from __future__ import annotations

import statistics
from typing import Any

from workbench.proof.benchmarks.handle import arm, hold, pixels, switch

DRAGS = 5
DRAG_PX = 24
SHOWN_MS = 2_000
"""Until the page shows what was switched on."""
LONGEST_MS = 20_000
"""After which a move is given up."""
REST_MS = 4_000
"""Between two drags: previews of the one before have come."""
WATCH_IMAGES = """
() => {
  window.pictures = [];
  document.addEventListener("load", event => {
    if (event.target.tagName === "IMG" && event.target.src.startsWith("blob:"))
      window.pictures.push(performance.now());
  }, true);
}
"""
"""Notes when an image of the page has a new picture."""
FIRST_PICTURE = "() => window.pictures.length ? window.pictures[0] - window.moved : 0"


def ring_drag_s(page: Any) -> float:
    """Median time from a move of the ring's handle to the changed preview in the page [s].

    Args:
        page: At a design whose image is computed.
    """
    page.locator('[role="tab"]').filter(has_text="Optics").click()
    page.wait_for_timeout(SHOWN_MS)
    before = pixels(page)
    switch(page, "Ring handle")
    page.wait_for_timeout(SHOWN_MS)
    page.evaluate(WATCH_IMAGES)
    x, y = arm(before, pixels(page))
    times = []
    for drag in range(DRAGS + 1):
        # Up first: the ring stands low. Each from where the last one has left it.
        hold(page, x, y)
        page.mouse.move(x, y - (-1) ** drag, steps=2)
        page.wait_for_timeout(REST_MS)
        page.evaluate("() => { window.pictures = []; window.moved = performance.now(); }")
        y -= DRAG_PX * (-1) ** drag
        page.mouse.move(x, y, steps=2)
        found_ms = page.wait_for_function(FIRST_PICTURE, timeout=LONGEST_MS).json_value()
        times.append(found_ms / 1000)
        page.wait_for_timeout(REST_MS)
        page.mouse.up()
        page.wait_for_timeout(REST_MS)
    switch(page, "Ring handle")
    # The first one also loads what renders it.
    return statistics.median(times[1:])
