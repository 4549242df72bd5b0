"""The browser front in headless Chromium: start, first use, slider to screen."""

from __future__ import annotations

import contextlib
import os
import shutil
import signal
import socket
import statistics
import subprocess
import sys
import tempfile
import time
import urllib.error
import urllib.request
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from workbench.rows import Row, bounded, failed

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
}
"""Case and limit [s] of each row, in the order they are measured."""
EDITS = 5
WATCH_UPLOADS = """
window.uploads = [];
window.addEventListener("keydown", () => { window.uploads = []; window.key = performance.now(); },
                        true);
for (const name of ["bufferData", "bufferSubData"]) {
  const real = WebGL2RenderingContext.prototype[name];
  WebGL2RenderingContext.prototype[name] = function (...given) {
    const size = Math.max(0, ...given.map(x => (x && x.byteLength) || 0));
    window.uploads.push([performance.now(), size]);
    return real.apply(this, given);
  };
}
"""
"""Notes when the page hands vertices to the graphics driver, and when a key was pressed."""
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
        command = [sys.executable, "-m", "workbench.cli", "run", "geltip"]
        command += ["--project", str(project), "--out", str(Path(text) / "out")]
        try:
            subprocess.run(command, check=True, capture_output=True)
            with _server(project) as (url, healthy_s), sync_playwright() as playwright:
                figures_s["healthz"] = healthy_s
                opened = playwright.chromium.launch(executable_path=program, args=list(FLAGS))
                page = opened.new_page(viewport={"width": 1280, "height": 900})
                start = time.perf_counter()
                page.add_init_script(WATCH_UPLOADS)
                page.goto(f"{url}/?fixedDpr=0.4")
                page.locator('[role="tab"]').filter(has_text="Optics").wait_for(timeout=60_000)
                figures_s["gui_usable"] = healthy_s + time.perf_counter() - start
                figures_s["slider_to_membrane"] = _slider_s(page)
                opened.close()
        except (Error, subprocess.SubprocessError) as error:
            return str(error)[:300]
    return ""


@contextlib.contextmanager
def _server(project: Path) -> Iterator[tuple[str, float]]:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    command = [sys.executable, "-m", "workbench.cli", "serve", "geltip", "--fast-scene"]
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
