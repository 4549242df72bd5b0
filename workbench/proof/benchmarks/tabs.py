"""What a second tab feels: how soon an edit reaches the server, and how long a job holds it up.

The second tab speaks the protocol itself (`workbench.proof.benchmarks.tab`), so that software
rendering is not measured with it.
"""

from __future__ import annotations

import statistics
import time
import urllib.request
from typing import Any

from workbench.proof.benchmarks.tab import Tab

KEYS = 9
FRAMES = 40
"""A press of so many frames takes 20 s or more on two cores."""
LONGEST_JOB_S = 25.0
STEP_S = 0.02
LENGTH = "Straight length mm"


def key_to_server_s(page: Any, url: str) -> float:
    """Median time from a key on a slider in a browser until the server tells another tab [s].

    The server hands the edit to its callback in the same step.
    """
    label = page.locator("label[for]").filter(has_text=LENGTH).first
    thumb = page.locator(f'[id="{label.get_attribute("for")}"]').locator('[role="slider"]')
    thumb.focus()
    times = []
    with Tab(url) as follower:
        uuid = follower.uuid(LENGTH)
        page.evaluate(
            "window.addEventListener('keydown', () => { window.keyAt = Date.now(); }, true)"
        )
        for _ in range(KEYS):
            before = len(follower.seen)
            page.keyboard.press("ArrowRight")
            arrived = follower.wait(lambda b=before: _update(follower, uuid, b), 10.0, "the edit")
            # Both clocks are of this machine: one of the wall, one monotonic.
            arrived += time.time() - time.monotonic()
            times.append(arrived - page.evaluate("window.keyAt") / 1000)
            page.wait_for_timeout(1_500)
    return statistics.median(times)


def _update(follower: Tab, uuid: str, begin: int) -> float:
    """When an update of a widget came, among messages from number `begin` on; 0 if none did."""
    for when, message in follower.seen[begin:]:
        if message["type"] == "GuiUpdateMessage" and message["uuid"] == uuid:
            if "value" in message["updates"]:
                return when
    return 0.0


def blocked_s(url: str) -> float:
    """Longest time that another tab waits for an answer while a press runs [s].

    Asked in turn: the page's health, and a slider of a tab that follows, which is put back.
    """
    with Tab(url) as editor:
        editor.uuid(LENGTH)
        with Tab(url) as follower:
            follower.uuid("Edit here")
            editor.set("Frames", FRAMES)
            editor.trigger("Run press")
            editor.wait(lambda: editor.has_seen("press: started"), 20.0, "the press runs")
            worst = 0.0
            deadline = time.monotonic() + LONGEST_JOB_S
            while time.monotonic() < deadline and not editor.has_seen("press: finished"):
                worst = max(worst, _health_s(url), _put_back_s(follower))
                time.sleep(STEP_S)
            editor.click("Cancel")
    return worst


def _health_s(url: str) -> float:
    start = time.perf_counter()
    urllib.request.urlopen(f"{url}/healthz", timeout=10).close()
    return time.perf_counter() - start


def _put_back_s(follower: Tab) -> float:
    kept = follower.value(LENGTH)
    start = time.perf_counter()
    follower.set(LENGTH, kept + 1.0)
    follower.wait(lambda: follower.value(LENGTH) == kept, 10.0, "the slider is put back")
    return time.perf_counter() - start
