"""The browser front in headless Chromium: start, first use, slider to screen."""

from __future__ import annotations

import contextlib
import os
import re
import shutil
import signal
import statistics
import subprocess
import sys
import tempfile
import time
import urllib.error
import urllib.request
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from workbench.project.design_toml import design_to_toml
from workbench.project.named_designs import load_design
from workbench.proof.benchmarks.playback import WATCH_DRAWS, frame_s
from workbench.proof.benchmarks.ring_drag import ring_drag_s
from workbench.proof.benchmarks.tabs import blocked_s, key_to_server_s
from workbench.proof.row import Row, bounded, failed
from workbench.system.free_port import free_port

FLAGS = (
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--ignore-gpu-blocklist",
    "--no-sandbox",
    "--disable-dev-shm-usage",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--no-first-run",
)
"""How Chromium runs without a display, a GPU or a network, here and in the browser tests."""
ROWS = {
    "healthz": ("finger cached", 10.0),
    "gui_usable": ("finger cached, software rendering", 20.0),
    "slider_to_membrane": ("key press to the new skin in graphics memory, software rendering", 0.5),
    "slider_to_callback": ("key press to the server's callback, another tab watching", 0.1),
    "other_tab_blocked": ("longest wait of a second tab while a press runs", 0.2),
    "playback_20k": ("frame to frame of a skin of 20 000 vertices, software rendering", 0.1),
    "touch_answered": ("move of the handle: placed, pressed and rendered by fast contact", 0.1),
    "drag_to_touch": (
        "move of the handle to the dent in graphics memory, software rendering",
        0.25,
    ),
    "ring_drag_to_preview": (
        "move of the LED ring's handle to the changed preview of the image",
        0.5,
    ),
    "drag_to_settled": ("release of the handle to the settled skin, software rendering", 2.0),
}
"""Case and limit [s] of each row, in the order they are measured."""
HEX_MM = 0.456
"""Edge of the cells at which the skin of the finger has 20 073 vertices."""
EDITS = 5
DRAGS = 3
DRAG_PX = 40
SETTLED_UPLOAD = """
() => {
  const large = window.uploads.filter(([when, size]) => size > 200000);
  return large.length ? large[large.length - 1][0] - window.key : 1e9;
}
"""
"""Time of the last upload of a whole pressed skin after the release [ms]; one has 241 kB."""
FIRST_DENT = SETTLED_UPLOAD.replace("large[large.length - 1]", "large[0]")
"""The same of the first."""
LIVE_ROWS = ("touch_answered", "drag_to_touch", "drag_to_settled")
ANSWERED = re.compile(r"at once, in (\d+\.\d+) s")
"""What the page says of a touch."""
READY_MS = 20_000
LEFT_DOCK_PX, RIGHT_DOCK_PX = 390, 355
BLUE_MARGIN = 50
"""How much more blue than red and green the upright arm of the handle is."""
WATCH_UPLOADS = """
window.uploads = [];
const forget = () => { window.uploads = []; window.key = performance.now(); };
for (const name of ["keydown", "pointerup"]) window.addEventListener(name, forget, true);
for (const name of ["bufferData", "bufferSubData"]) {
  const real = WebGL2RenderingContext.prototype[name];
  WebGL2RenderingContext.prototype[name] = function (...given) {
    const size = Math.max(0, ...given.map(x => (x && x.byteLength) || 0));
    window.uploads.push([performance.now(), size]);
    return real.apply(this, given);
  };
}
"""
"""Notes vertices handed to the graphics driver, and when a key went down or a button up."""
FIRST_UPLOAD = """
() => {
  const large = window.uploads.filter(([when, size]) => size > 20000);
  return large.length ? large[0][0] - window.key : 1e9;
}
"""
"""Time of the first large upload after the key [ms]; the skin has 27 kB of vertices."""


def rows() -> list[Row]:
    """All rows of the room; not ok where no browser can be driven."""
    program = os.environ.get("CHROMIUM") or shutil.which("chromium")
    figures_s: dict[str, float] = {}
    why = "needs playwright and Chromium: make bench brings them"
    if program is not None:
        with contextlib.suppress(ImportError):
            why = _measure(program, figures_s)
    return [
        bounded(name, case, figures_s[name], unit="s", limit=limit_s)
        if name in figures_s
        else failed(name, case, unit="s", why=why)
        for name, (case, limit_s) in ROWS.items()
    ]


def _measure(program: str, figures_s: dict[str, float]) -> str:
    """Fill in the figures one after the other; returns what stopped it, empty when nothing."""
    from playwright.sync_api import Error, sync_playwright

    with tempfile.TemporaryDirectory() as text:
        project = Path(text) / "project"
        finger = Path(text) / "geltip.toml"
        design = load_design("geltip")
        meshing = replace(design.meshing, hex_mm=HEX_MM)
        finger.write_text(design_to_toml(replace(design, meshing=meshing)), encoding="utf-8")
        command = [sys.executable, "-m", "workbench.cli", "run", str(finger)]
        command += ["--project", str(project), "--out", str(Path(text) / "out")]
        try:
            subprocess.run(command, check=True, capture_output=True)
            with _server(finger, project) as (url, healthy_s), sync_playwright() as playwright:
                figures_s["healthz"] = healthy_s
                opened = playwright.chromium.launch(executable_path=program, args=list(FLAGS))
                page = opened.new_page(viewport={"width": 1280, "height": 900}, color_scheme="dark")
                start = time.perf_counter()
                page.add_init_script(WATCH_UPLOADS)
                page.add_init_script(WATCH_DRAWS)
                page.goto(f"{url}/?fixedDpr=0.4")
                page.locator('[role="tab"]').filter(has_text="Optics").wait_for(timeout=60_000)
                figures_s["gui_usable"] = healthy_s + time.perf_counter() - start
                figures_s["playback_20k"] = frame_s(page)[0]
                figures_s.update(drags_s(page))
                figures_s["ring_drag_to_preview"] = _ring_drag_s(page)
                page.locator('[role="tab"]').filter(has_text="Shape").click()
                figures_s["slider_to_membrane"] = _slider_s(page)
                figures_s["slider_to_callback"] = key_to_server_s(page, url)
                opened.close()
                figures_s["other_tab_blocked"] = blocked_s(url)
        except (Error, TimeoutError, subprocess.SubprocessError) as error:
            return str(error)[:300]
    return ""


@contextlib.contextmanager
def _server(design: Path, project: Path) -> Iterator[tuple[str, float]]:
    port = free_port()
    command = [
        sys.executable,
        "-m",
        "workbench.cli",
        "serve",
        str(design),
        "--fast-scene",
        "--no-tour",
    ]
    command += ["--project", str(project), "--port", str(port)]
    start = time.perf_counter()
    with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as server:
        url = f"http://127.0.0.1:{port}"
        while time.perf_counter() - start < 60:
            with contextlib.suppress(urllib.error.URLError, OSError):
                urllib.request.urlopen(f"{url}/healthz", timeout=1).close()
                break
            time.sleep(0.05)
        healthy_s = time.perf_counter() - start
        try:
            yield url, healthy_s
        finally:
            server.send_signal(signal.SIGINT)
            server.wait(20)


def _slider_s(page: Any) -> float:
    """Median time from a key on the length slider to the new skin in the graphics memory [s]."""
    # Until the lanes are warm and the page is quiet.
    page.wait_for_timeout(15_000)
    label = page.locator("label[for]").filter(has_text="Straight length mm").first
    thumb = page.locator(f'[id="{label.get_attribute("for")}"]').locator('[role="slider"]')
    thumb.focus()
    times = []
    for _ in range(EDITS):
        page.keyboard.press("ArrowLeft")
        page.wait_for_timeout(3_000)
        times.append(page.evaluate(FIRST_UPLOAD) / 1000)
    return statistics.median(times)


def _ring_drag_s(page: Any) -> float:
    page.locator('[role="tab"]').filter(has_text="Optics").click()
    page.wait_for_timeout(2_000)
    before = pixels(page)

    def shown() -> tuple[int, int]:
        label = page.locator("label[for]").filter(has_text="Ring handle").first
        page.locator(f'[id="{label.get_attribute("for")}"]').click(force=True)
        page.wait_for_timeout(2_000)
        return arm(before, pixels(page))

    return ring_drag_s(page, shown)


def drags_s(page: Any) -> dict[str, float]:
    """Median times of a live press by row [s]: of fast contact's answer, from a move of the handle
    to the dent in the graphics memory, and from letting it go to the settled one there."""
    page.locator('[role="tab"]').filter(has_text="Simulate").click()
    label = page.locator("label[for]").filter(has_text="Live").first
    before = pixels(page)
    page.locator(f'[id="{label.get_attribute("for")}"]').click(force=True)
    page.get_by_text("settled in").wait_for()
    # The lanes load kernels, the page its first skin, and the skin is made ready.
    page.wait_for_timeout(READY_MS)
    times: dict[str, list[float]] = {name: [] for name in LIVE_ROWS}
    for drag in range(DRAGS):
        x, y = arm(before, pixels(page))
        page.mouse.move(x, y)
        page.wait_for_timeout(500)
        page.mouse.down()
        # The handle is held from its first move on.
        page.mouse.move(x, y + (-1) ** drag, steps=2)
        page.wait_for_timeout(2_000)
        page.evaluate("() => { window.uploads = []; window.key = performance.now(); }")
        page.mouse.move(x, y + DRAG_PX * (-1) ** drag, steps=2)
        said = page.get_by_text(ANSWERED)
        said.wait_for()
        answered = ANSWERED.search(said.inner_text())
        times["touch_answered"].append(float(answered[1]) if answered else float("nan"))
        # The graphics memory has the dent a little later than the page its words.
        page.wait_for_timeout(1_000)
        times["drag_to_touch"].append(page.evaluate(FIRST_DENT) / 1000)
        page.mouse.up()
        page.wait_for_timeout(6_000)
        times["drag_to_settled"].append(page.evaluate(SETTLED_UPLOAD) / 1000)
    page.locator(f'[id="{label.get_attribute("for")}"]').click(force=True)
    return {name: statistics.median(found) for name, found in times.items()}


def pixels(page: Any) -> np.ndarray:
    """The page as shown, shape (H, W, 3) of blue, green, red."""
    import cv2

    data = np.frombuffer(page.screenshot(), dtype=np.uint8)
    return np.asarray(cv2.imdecode(data, cv2.IMREAD_COLOR), dtype=np.int16)


def arm(before: np.ndarray, after: np.ndarray) -> tuple[int, int]:
    """Pixel of the tip of the handle's upright arm: the highest blue that was not there before."""
    blue, green, red = np.moveaxis(after, -1, 0)
    found = (np.abs(after - before).sum(axis=2) > 60) & (blue > red + BLUE_MARGIN)
    found &= blue > green + BLUE_MARGIN // 2
    # The docks are blue too.
    found[:, :LEFT_DOCK_PX] = found[:, -RIGHT_DOCK_PX:] = False
    rows, columns = np.nonzero(found)
    if not len(rows):
        raise ValueError("the handle is not on screen")
    top = int(rows.min())
    return int(np.median(columns[rows < top + 10])), top + 7
