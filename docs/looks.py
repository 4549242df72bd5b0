"""Photograph every page and dock in every size, dark and light, and list what looks wrong.

`make looks`, or `python -m docs.looks` in the root of the repository, starts a server with a coarse
finger in `out/looks/project` (kept for the next time), and writes into `out/looks`: a PNG for each
size, theme and tab, once as it opens and once with its folders open, and of the small laptop as
colour-blind people see it, `faults.json`, and the same to
read in `faults.txt`. Needs what `make test` installs. Words narrow it down to
names that contain one: `python -m docs.looks 1280x720-dark`.
"""

from __future__ import annotations

import json
import os
import re
import shutil
import sys
from collections import defaultdict
from dataclasses import asdict
from pathlib import Path
from typing import Any

from playwright.sync_api import sync_playwright

from docs.page_shots import pressed
from tests.ui.axe import axe_faults, axe_script
from tests.ui.conftest import SOFTWARE, Server
from tests.ui.page_faults import Fault, docks_share, faults, places, quiet, unfold
from tests.ui.widgets import DRAW_WHEN_LOOKED_AT, coarse_project, looking, tab
from ui.page.theme import DARK, LIGHT, STORED

OUT = Path("out/looks")
SIZES = ((1280, 720), (1440, 900), (1920, 1080), (400, 800))
"""Pixels of a small laptop, a laptop, a desktop, and a window for reading results."""
KEEP_DRAWN = """
const open = HTMLCanvasElement.prototype.getContext;
HTMLCanvasElement.prototype.getContext = function (kind, given) {
  return open.call(this, kind, kind === "webgl2" ? {...given, preserveDrawingBuffer: true} : given);
};
"""
"""What was drawn of the 3D view stays while nothing is drawn, for the pictures that follow."""
COLOUR_BLIND = ("deuteranopia", "protanopia", "tritanopia")
SEEN_OTHERWISE = "1280x720"
"""Of this size there are pictures of how colour-blind people see the page."""
CHOOSE = "localStorage.setItem('viser-user:{key}', '{choice}')"


def main(wanted: list[str]) -> None:
    """Write all pictures and faults of the sizes and themes that are wanted."""
    program = os.environ.get("CHROMIUM") or shutil.which("chromium")
    script = axe_script()
    if script is None:
        print("no axe-core: npm could not bring it", flush=True)
    project = OUT / "project"
    if not project.is_dir():
        coarse_project(OUT)
    shares: dict[str, float] = {}
    found: dict[Fault, list[str]] = defaultdict(list)
    with Server(project.resolve()) as server, sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=program, args=list(SOFTWARE))
        for width, height in SIZES:
            for choice in (DARK, LIGHT):
                look = f"{width}x{height}-{choice}"
                if wanted and not any(word in look for word in wanted):
                    continue
                page = browser.new_page(viewport={"width": width, "height": height})
                page.add_init_script(KEEP_DRAWN + DRAW_WHEN_LOOKED_AT)
                page.add_init_script(CHOOSE.format(key=STORED, choice=choice))
                opened(page, server.url)
                shares[look] = docks_share(page)
                for name, fault in looks(page, look, script):
                    found[fault].append(f"{look}-{name}")
                page.close()
        browser.close()
    write(shares, found)


def opened(page: Any, url: str) -> None:
    """Open the workbench and wait for the example's image."""
    page.set_default_timeout(60_000)
    page.goto(url)
    tab(page, "Shape").wait_for()
    pressed(page)
    with looking(page):
        page.wait_for_timeout(3_000)


def looks(page: Any, look: str, script: str | None) -> list[tuple[str, Fault]]:
    """Photograph all tabs, closed and open; faults with the tab that has them, by axe too."""
    found = []
    for name in places(page):
        short = re.sub(r"\W+", "_", name).strip("_").lower() or "help"
        page.screenshot(path=OUT / f"{look}-{short}.png")
        if look.startswith(SEEN_OTHERWISE):
            colour_blind(page, f"{look}-{short}")
        unfold(page)
        quiet(page)
        page.screenshot(path=OUT / f"{look}-{short}-open.png")
        found += [(short, fault) for fault in faults(page)]
        if script is not None:
            found += [(short, fault) for fault in axe_faults(page, script)]
        print(f"{look} {name}", flush=True)
    return found


def colour_blind(page: Any, name: str) -> None:
    """Photograph a tab as Chromium simulates three kinds of colour-blindness (Machado 2009)."""
    session = page.context.new_cdp_session(page)
    for kind in (*COLOUR_BLIND, "none"):
        session.send("Emulation.setEmulatedVisionDeficiency", {"type": kind})
        if kind != "none":
            page.screenshot(path=OUT / f"{name}-{kind}.png")
    session.detach()


def write(shares: dict[str, float], found: dict[Fault, list[str]]) -> None:
    """Both lists; a fault that several tabs have stands there once."""
    rows = [{**asdict(fault), "where": found[fault]} for fault in sorted(found)]
    text = json.dumps({"share_of_docks": shares, "faults": rows}, indent=1, ensure_ascii=False)
    (OUT / "faults.json").write_text(text + "\n", encoding="utf-8")
    lines = [f"docks take {100 * share:.0f} % of {look}" for look, share in shares.items()]
    alike: dict[tuple[str, str], list[Fault]] = defaultdict(list)
    for fault in sorted(found):
        alike[fault.kind, fault.more].append(fault)
    for (kind, more), group in alike.items():
        what = ", ".join(fault.what for fault in group)
        lines.append(f"{kind}, {more}: {what}; first in {found[group[0]][0]}")
    (OUT / "faults.txt").write_text("\n".join(lines) + "\n", encoding="utf-8")
    print("\n".join(lines))


if __name__ == "__main__":
    main(sys.argv[1:])
