"""The browser front in headless Chromium: start, first use, slider to screen."""

from __future__ import annotations

import contextlib
import os
import shutil
import signal
import statistics
import subprocess
import sys
import tempfile
import time
import urllib.error
import urllib.request
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

from workbench.project.design_toml import design_to_toml
from workbench.project.named_designs import load_design
from workbench.proof.benchmarks.live_drag import LIVE_ROWS, live_drag_s
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
  return large.length ? large[0][0] - window.key : 0;
}
"""
"""Time of the first large upload after the key [ms], 0 before; the skin has 27 kB of vertices."""


def rows() -> list[Row]:
    """All rows of the room; not ok where no browser can be driven."""
    program = os.environ.get("CHROMIUM") or shutil.which("chromium")
    figures_s: dict[str, float] = {}
    why = dict.fromkeys(ROWS, "needs playwright and Chromium: make bench brings them")
    if program is not None:
        with contextlib.suppress(ImportError):
            _measure(program, figures_s, why)
    return [
        bounded(name, case, figures_s[name], unit="s", limit=limit_s)
        if name in figures_s
        else failed(name, case, unit="s", why=why[name])
        for name, (case, limit_s) in ROWS.items()
    ]


def _measure(program: str, figures_s: dict[str, float], why: dict[str, str]) -> None:
    """Fill in the figures one after the other, and why one could not be measured."""
    from playwright.sync_api import Error, sync_playwright

    with tempfile.TemporaryDirectory() as text:
        project = Path(text) / "project"
        finger = Path(text) / "geltip.toml"
        design = load_design("geltip")
        meshing = replace(design.meshing, hex_mm=HEX_MM)
        finger.write_text(design_to_toml(replace(design, meshing=meshing)), encoding="utf-8")
        command = [sys.executable, "-m", "workbench.cli", "run", str(finger)]
        command += ["--project", str(project), "--out", str(Path(text) / "out")]
        with contextlib.ExitStack() as stack:
            try:
                subprocess.run(command, check=True, capture_output=True)
                url, healthy_s = stack.enter_context(_server(finger, project))
                chromium = stack.enter_context(sync_playwright()).chromium
                opened = chromium.launch(executable_path=program, args=list(FLAGS))
                stack.callback(opened.close)
                start = time.perf_counter()
                page = _page(opened, url)
            except (Error, OSError, subprocess.SubprocessError) as error:
                why.update(dict.fromkeys(ROWS, _words(error)))
                return
            figures_s["healthz"] = healthy_s
            figures_s["gui_usable"] = healthy_s + time.perf_counter() - start
            for names, measure in STEPS:
                try:
                    figures_s.update(zip(names, measure(page, url), strict=True))
                except (Error, TimeoutError, ValueError, KeyError) as error:
                    why.update(dict.fromkeys(names, _words(error)))
                    # What it has left half done must not stop the next one.
                    page.close()
                    page = _page(opened, url)


def _words(error: Exception) -> str:
    return str(error)[:300]


def _page(browser: Any, url: str) -> Any:
    """A new page that is usable."""
    page = browser.new_page(viewport={"width": 1280, "height": 900}, color_scheme="dark")
    page.add_init_script(WATCH_UPLOADS)
    page.add_init_script(WATCH_DRAWS)
    page.goto(f"{url}/?fixedDpr=0.4")
    page.locator('[role="tab"]').filter(has_text="Optics").wait_for(timeout=60_000)
    return page


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
    page.locator('[role="tab"]').filter(has_text="Shape").click()
    # Until the lanes are warm and the page is quiet.
    page.wait_for_timeout(15_000)
    label = page.locator("label[for]").filter(has_text="Straight length mm").first
    thumb = page.locator(f'[id="{label.get_attribute("for")}"]').locator('[role="slider"]')
    thumb.focus()
    times = []
    for _ in range(EDITS):
        page.keyboard.press("ArrowLeft")
        times.append(page.wait_for_function(FIRST_UPLOAD, timeout=20_000).json_value() / 1000)
        page.wait_for_timeout(3_000)
    return statistics.median(times)


STEPS: tuple[tuple[tuple[str, ...], Callable[[Any, str], tuple[float, ...]]], ...] = (
    (("playback_20k",), lambda page, url: frame_s(page)[:1]),
    (LIVE_ROWS, live_drag_s),
    (("ring_drag_to_preview",), lambda page, url: (ring_drag_s(page),)),
    (("slider_to_membrane",), lambda page, url: (_slider_s(page),)),
    (("slider_to_callback",), lambda page, url: (key_to_server_s(page, url),)),
    # The last one: no page may edit meanwhile.
    (("other_tab_blocked",), lambda page, url: (page.close(), blocked_s(url))[1:]),
)
"""What fills in which rows, in turn; each from any tab of the page."""
