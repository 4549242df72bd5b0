"""Take the screenshots of the README from the running workbench.

`.venv/bin/python docs/screenshots.py` starts a server in a fresh project, waits until the example
is pressed, and writes `docs/*.png`. Needs what `make test` installs.
"""

from __future__ import annotations

import os
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
import urllib.error
import urllib.request
from pathlib import Path

from playwright.sync_api import Page, sync_playwright

from workbench.benchmarks.browser import FLAGS

FOLDER = Path(__file__).parent
PRESSED_S = 300


def free_port() -> int:
    """A port that nobody listens on."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


def wait_for_server(url: str) -> None:
    """Until `/healthz` answers."""
    for _ in range(600):
        try:
            urllib.request.urlopen(f"{url}/healthz", timeout=1).close()
            return
        except (urllib.error.URLError, OSError):
            time.sleep(0.1)
    raise SystemExit("the server did not start")


def shoot(page: Page, name: str) -> None:
    """One picture, once the 3D view has caught up."""
    page.wait_for_timeout(6_000)
    page.screenshot(path=str(FOLDER / f"{name}.png"))


def main() -> None:
    """Write all pictures."""
    program = os.environ.get("CHROMIUM") or shutil.which("chromium")
    port = free_port()
    with tempfile.TemporaryDirectory() as project, sync_playwright() as playwright:
        command = [sys.executable, "-m", "workbench.cli", "serve", "--port", str(port)]
        server = subprocess.Popen([*command, "--project", project, "--fast-scene", "--no-tour"])
        try:
            wait_for_server(f"http://127.0.0.1:{port}")
            browser = playwright.chromium.launch(executable_path=program, args=list(FLAGS))
            page = browser.new_page(viewport={"width": 1440, "height": 860})
            page.goto(f"http://127.0.0.1:{port}/")
            page.get_by_text("Image ✓").wait_for(timeout=PRESSED_S * 1000)
            page.locator(
                "button[aria-label='Close'], .mantine-Notification-closeButton"
            ).first.click(timeout=3_000)
            shoot(page, "workbench")
            page.locator('[role="tab"]').filter(has_text="Make").click()
            page.get_by_role("button", name="Make parts", exact=True).click()
            page.get_by_role("button", name="Download part STL", exact=True).wait_for(
                timeout=180_000
            )
            shoot(page, "mould")
            browser.close()
        finally:
            server.send_signal(signal.SIGINT)
            server.wait(20)


if __name__ == "__main__":
    main()
