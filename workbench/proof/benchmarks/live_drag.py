"""How soon the skin follows the handle of the live press, in headless Chromium."""

from __future__ import annotations

import re
import statistics
from typing import Any

from workbench.proof.benchmarks.handle import LEFT_DOCK_PX, arm, hold, pixels, switch
from workbench.proof.benchmarks.tab import Tab

LIVE_ROWS = ("touch_answered", "drag_to_touch", "drag_to_settled")
DRAGS = 3
DRAG_PX = 40
ASIDE_PX = (LEFT_DOCK_PX + 10, 10)
"""A place of the view with nothing under the mouse."""
SETTLED_UPLOAD = """
() => {
  const large = window.uploads.filter(([when, size]) => size > 200000);
  return large.length ? large[large.length - 1][0] - window.key : 0;
}
"""
"""Time of the last upload of a whole pressed skin after the release [ms], 0 before; one has 241 kB.
"""
FIRST_DENT = SETTLED_UPLOAD.replace("large[large.length - 1]", "large[0]")
"""The same of the first."""
ANSWERED = re.compile(r"at once, in (\d+\.\d+) s")
"""What the page says of a touch."""
SETTLED = re.compile(r"settled in")
READY_MS, SHOWN_MS = 20_000, 6_000
FIRST_S, LONGEST_S = 90.0, 20.0
"""After which the first press, which loads what presses, and a move are given up."""


def live_drag_s(page: Any, url: str) -> tuple[float, ...]:
    """Median times of a live press [s], of `LIVE_ROWS`.

    They are those of fast contact's answer, from a move of the handle to the dent in the graphics
    memory, and from letting it go to the settled one there. What is said is heard by a tab of its
    own: once the press settles other words take its place, which a slow page shows alone.
    """
    page.locator('[role="tab"]').filter(has_text="Simulate").click()
    before = pixels(page)
    with Tab(url) as follower:
        follower.uuid("Live")
        switch(page, "Live")
        try:
            _heard(follower, 0, SETTLED, FIRST_S)
            # The lanes load kernels, the page its first skin, and the skin is made ready.
            page.wait_for_timeout(READY_MS)
            times = [_drag_s(page, follower, arm(before, pixels(page)), k) for k in range(DRAGS)]
        finally:
            page.mouse.up()
            switch(page, "Live")
    return tuple(statistics.median(found) for found in zip(*times, strict=True))


def _drag_s(
    page: Any, follower: Tab, tip: tuple[int, int], number: int
) -> tuple[float, float, float]:
    """Drag the handle, which is held by the tip of its arm, down or up, and let it go."""
    x, y = tip
    way = (-1) ** number
    hold(page, x, y)
    # The handle is held from its first move on.
    page.mouse.move(x, y + way, steps=2)
    page.wait_for_timeout(2_000)
    begin = len(follower.seen)
    page.evaluate("() => { window.uploads = []; window.key = performance.now(); }")
    page.mouse.move(x, y + DRAG_PX * way, steps=2)
    answered_s = float(_heard(follower, begin, ANSWERED)[1])
    # The graphics memory has the dent a little later than a tab its words.
    dent_s = page.wait_for_function(FIRST_DENT, timeout=1e3 * LONGEST_S).json_value() / 1e3
    page.mouse.up()
    # An arm under the mouse is not blue: the next drag would not find it.
    page.mouse.move(*ASIDE_PX)
    # Once it has settled, held or not, the handle stands where the next drag finds it.
    _heard(follower, begin, SETTLED, FIRST_S)
    page.wait_for_timeout(SHOWN_MS)
    settled_ms = page.wait_for_function(SETTLED_UPLOAD, timeout=1e3 * LONGEST_S).json_value()
    return answered_s, dent_s, settled_ms / 1e3


def _heard(
    follower: Tab, begin: int, words: re.Pattern[str], seconds: float = LONGEST_S
) -> re.Match[str]:
    """Words in a message from number `begin` on, once they have come."""

    def found() -> re.Match[str] | None:
        texts = (str(message) for _, message in follower.seen[begin:])
        return next((match for text in texts if (match := words.search(text))), None)

    return follower.wait(found, seconds, f"the page says: {words.pattern}")
