"""Playing the frames of a press in the browser: time from one skin drawn to the next.

Each frame is a mesh with buffers of its own, and the skin at rest is a smaller mesh: an image with
another large mesh than the image before, or without one, is a frame that was applied.
"""

from __future__ import annotations

from typing import Any

WATCH_DRAWS = """
window.applied = []; window.bound = null; window.skin = null; window.drawn = [null, 0];
const bind = WebGL2RenderingContext.prototype.bindVertexArray;
WebGL2RenderingContext.prototype.bindVertexArray = function (given) {
  window.bound = given;
  return bind.call(this, given);
};
const clear = WebGL2RenderingContext.prototype.clear;
WebGL2RenderingContext.prototype.clear = function (...given) {
  if (window.drawn[0] !== window.skin) {
    window.skin = window.drawn[0];
    window.applied.push([performance.now(), window.drawn[1]]);
  }
  window.drawn = [null, 0];
  return clear.apply(this, given);
};
const draw = WebGL2RenderingContext.prototype.drawElements;
WebGL2RenderingContext.prototype.drawElements = function (...given) {
  if (given[1] > 30000) window.drawn = [window.bound, given[1]];
  return draw.apply(this, given);
};
"""
"""Notes when the large mesh of an image was another than before [ms], and its corners."""
WARM_MS, SPAN_MS = 6_000, 8_000


def frame_s(page: Any) -> tuple[float, int]:
    """Mean time between frames applied at speed 1 [s], and triangles of the skin."""
    page.locator('[role="tab"]').filter(has_text="Pace").click()
    label = page.locator("label[for]").filter(has_text="Loop").first
    page.locator(f'[id="{label.get_attribute("for")}"]').click(force=True)
    page.locator('[role="tab"]').filter(has_text="Timeline").click()
    play = page.get_by_role("button", name="Play / pause", exact=True)
    play.click()
    page.wait_for_timeout(WARM_MS)
    page.evaluate("() => { window.applied = []; }")
    page.wait_for_timeout(SPAN_MS)
    applied = page.evaluate("() => window.applied")
    play.click()
    return SPAN_MS / 1000 / max(len(applied), 1), max((n for _, n in applied), default=0) // 3
