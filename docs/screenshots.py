"""Take the screenshots of README and tutorial from the running workbench.

`.venv/bin/python -m docs.screenshots` in the root of the repository starts a server in a fresh
project, does what the tutorial says, and writes `docs/screens/*.webp`. Needs what `make test`
installs, and takes some ten minutes on two processor cores. Names given as words take those only;
`WORKBENCH_PROJECT` names a project whose results are kept for the next time:
`... -m docs.screenshots section make`.
"""

from __future__ import annotations

import os
import shutil
import sys
import tempfile
from pathlib import Path

from playwright.sync_api import sync_playwright

from docs.page_shots import FOLDER, SIZE, pressed
from docs.screen_steps import STEPS
from tests.ui.conftest import Server
from tests.ui.page_faults import quiet
from tests.ui.widgets import tab
from workbench.proof.benchmarks.browser import FLAGS

PRESETS = Path(__file__).parent.parent / "designs" / "presets"
PRESS = """
[press_case.press]
frames = 6
depth_mm = 1.0
[press_case.settings]
grid_mm = 0.7
"""
"""A coarser press than the program's own: the screenshots shall not take an hour."""


def main(wanted: list[str]) -> None:
    """Write the screenshots that are wanted, all of them without a word."""
    program = os.environ.get("CHROMIUM") or shutil.which("chromium")
    FOLDER.mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as playwright:
        project = Path(os.environ.get("WORKBENCH_PROJECT") or Path(folder) / "project")
        (project / "designs").mkdir(parents=True, exist_ok=True)
        design = (PRESETS / "geltip.toml").read_text(encoding="utf-8") + PRESS
        (project / "designs" / "autosave.toml").write_text(design, encoding="utf-8")
        server = Server(project)
        try:
            browser = playwright.chromium.launch(executable_path=program, args=list(FLAGS))
            page = browser.new_page(viewport=SIZE, color_scheme="dark")  # pyright: ignore[reportArgumentType]
            page.set_default_timeout(60_000)
            page.goto(server.url)
            tab(page, "Shape").wait_for()
            quiet(page)
            pressed(page)
            quiet(page)
            for name in wanted or STEPS:
                STEPS[name](page)
            browser.close()
        finally:
            server.stop()


if __name__ == "__main__":
    main(sys.argv[1:])
