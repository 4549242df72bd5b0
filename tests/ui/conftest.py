"""A workbench server and a headless Chromium for the browser tests."""

from __future__ import annotations

import contextlib
import os
import shutil
import signal
import subprocess
import sys
import time
import urllib.error
import urllib.request
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, Self

import pytest

from tests.ui.warm_start import WarmStart
from tests.ui.widgets import DRAW_WHEN_LOOKED_AT, coarse_project
from workbench.proof.benchmarks.browser import FLAGS
from workbench.proof.benchmarks.tab import Tab
from workbench.system.free_port import free_port

START_LIMIT_S = 60
SOFTWARE = (*FLAGS, "--disable-gpu-compositing")
"""The page is put together without the software GPU: that took more time than all workers."""


class Server:
    """A workbench in its own process, as a user starts it, or as a fork of `warm`."""

    def __init__(
        self, project: Path, *words: str, tour: bool = False, warm: WarmStart | None = None
    ) -> None:
        self.project = project
        self.port = free_port()
        self.url = f"http://127.0.0.1:{self.port}"
        self.log = project.parent / f"server-{self.port}.log"
        command = ["serve", *words, "--port", str(self.port), "--project", str(project)]
        command += ["--fast-scene"] if tour else ["--fast-scene", "--no-tour"]
        started = time.monotonic()
        self.process: Any
        if warm is not None:
            self.process = warm.start(command, project, self.log)
        else:
            cold = [sys.executable, "-u", "-m", "workbench.cli", *command]
            with self.log.open("wb") as out:
                self.process = subprocess.Popen(cold, stdout=out, stderr=out)
        self._wait()
        self.seconds_to_healthy = time.monotonic() - started

    def _wait(self) -> None:
        deadline = time.monotonic() + START_LIMIT_S
        while time.monotonic() < deadline:
            with contextlib.suppress(urllib.error.URLError, OSError):
                with urllib.request.urlopen(f"{self.url}/healthz", timeout=1) as answer:
                    if answer.status == 200:
                        return
            if self.process.poll() is not None:
                break
            time.sleep(0.1)
        raise RuntimeError(f"the server did not start:\n{self.log.read_text()}")

    def stop(self) -> None:
        """Ctrl-C, as a user would."""
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGINT)
            with contextlib.suppress(subprocess.TimeoutExpired):
                self.process.wait(15)
        self.kill()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *error: object) -> None:
        self.stop()

    def kill(self) -> None:
        """kill -9."""
        self.process.kill()
        self.process.wait(10)


@pytest.fixture(scope="package")
def warm() -> Iterator[WarmStart]:
    """What servers are forks of."""
    start = WarmStart()
    yield start
    start.close()


@pytest.fixture
def start_server(warm: WarmStart) -> Iterator[Callable[..., Server]]:
    """Starts servers and stops them after the test; `cold` ones as a user does."""
    servers: list[Server] = []

    def start(project: Path, *words: str, tour: bool = False, cold: bool = False) -> Server:
        servers.append(Server(project, *words, tour=tour, warm=None if cold else warm))
        return servers[-1]

    yield start
    for server in servers:
        server.stop()
        # Shown by pytest beside a test that failed.
        print(server.log.read_text()[-4000:])


@pytest.fixture(scope="package")
def browser() -> Iterator[Any]:
    """Headless Chromium with software rendering; its event loop must not outlive these tests."""
    sync_api = pytest.importorskip("playwright.sync_api")
    program = os.environ.get("CHROMIUM") or shutil.which("chromium")
    if program is None:
        pytest.fail("no Chromium: run `make test`, or set CHROMIUM to the path of one")
    with sync_api.sync_playwright() as playwright:
        opened = playwright.chromium.launch(
            executable_path=program, args=list(SOFTWARE), headless=True
        )
        yield opened
        opened.close()


@pytest.fixture(scope="package")
def pressed_store(warm: WarmStart, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The store of a coarse project whose example was pressed as for a first tab."""
    project = coarse_project(tmp_path_factory.mktemp("pressed"))
    with Server(project, warm=warm) as server, Tab(server.url) as tab:
        tab.wait(lambda: tab.has_seen("Image&nbsp;\N{CHECK MARK}"), 180, "the example is pressed")
    return project / "store"


@pytest.fixture
def pressed_project(pressed_store: Path, tmp_path: Path) -> Path:
    """A coarse project whose press is found in its store: for tests of what comes after it."""
    project = coarse_project(tmp_path)
    shutil.copytree(pressed_store, project / "store")
    return project


@pytest.fixture
def unpressed_project(pressed_store: Path, tmp_path: Path) -> Path:
    """A coarse project whose body alone is in its store: nothing is pressed before one asks."""
    project = coarse_project(tmp_path)
    shutil.copytree(pressed_store / "build", project / "store" / "build")
    return project


@pytest.fixture
def page(browser: Any) -> Iterator[Any]:
    """A fresh tab that may download; its 3D view is drawn while a test looks at it."""
    context = browser.new_context(
        viewport={"width": 1280, "height": 1000}, accept_downloads=True, color_scheme="dark"
    )
    context.add_init_script(DRAW_WHEN_LOOKED_AT)
    tab = context.new_page()
    tab.set_default_timeout(60_000)
    yield tab
    if not tab.is_closed():
        # Shown by pytest beside a test that failed.
        print("the page showed", tab.evaluate("document.body.innerText"), sep="\n")
    context.close()
