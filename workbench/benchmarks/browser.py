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
    "--disable-background-networking",
    "--no-first-run",
)
NAMES = ("healthz", "gui_usable", "slider_to_membrane")
EDITS = 5


def rows() -> list[Row]:
    """All rows of the room; not ok where no browser can be driven."""
    program = os.environ.get("CHROMIUM") or shutil.which("chromium")
    try:
        from playwright.sync_api import sync_playwright
    except ImportError:
        program = None
    if program is None:
        return [failed(name, "needs playwright and Chromium: make test") for name in NAMES]
    with tempfile.TemporaryDirectory() as text:
        project = Path(text) / "project"
        command = [sys.executable, "-m", "workbench.cli", "run", "geltip"]
        command += ["--project", str(project), "--out", str(Path(text) / "out")]
        subprocess.run(command, check=True, capture_output=True)
        with _server(project) as (url, healthy_s), sync_playwright() as playwright:
            opened = playwright.chromium.launch(executable_path=program, args=list(FLAGS))
            page = opened.new_page(viewport={"width": 1280, "height": 900})
            start = time.perf_counter()
            page.goto(f"{url}/?fixedDpr=0.4")
            page.locator('[role="tab"]').filter(has_text="Optics").wait_for(timeout=60_000)
            usable_s = healthy_s + time.perf_counter() - start
            slider_s = _slider_s(page)
            opened.close()
    case = "finger cached"
    return [
        bounded("healthz", case, healthy_s, unit="s", limit=10.0),
        bounded("gui_usable", f"{case}, software rendering", usable_s, unit="s", limit=20.0),
        bounded(
            "slider_to_membrane",
            "key press to the rebuilt body in the stage strip",
            slider_s,
            unit="s",
            limit=0.5,
        ),
    ]


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
    """Median time from a key on the length slider until the strip shows the new body [s]."""
    # Twice a browser's tick, so that the lanes are warm and the page is quiet.
    page.wait_for_timeout(15_000)
    label = page.locator("label[for]").filter(has_text="Straight length mm").first
    thumb = page.locator(f'[id="{label.get_attribute("for")}"]').locator('[role="slider"]')
    thumb.focus()
    times = []
    for _ in range(EDITS):
        start = time.perf_counter()
        page.keyboard.press("ArrowLeft")
        page.get_by_text("Mesh ○").wait_for(timeout=10_000)
        page.get_by_text("Shape ✓").wait_for(timeout=10_000)
        times.append(time.perf_counter() - start)
        page.wait_for_timeout(1_500)
    return statistics.median(times)
