"""axe-core in the page: rules of WCAG 2.2 that a program can check, as faults of the page.

npm brings it, once, into `out/axe`, which git ignores; without npm or a registry there is none.
Contrast is left to `page_faults.py`, which knows what viser draws behind its texts. Sizes of
targets are left out: boxes and their arrows are viser's, and stand closer than 24 px.
"""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path
from typing import Any

from tests.ui.page_faults import Fault

VERSION = "4.14.1"
FOLDER = Path("out/axe")
FETCH_S = 120
RUN = """
async () => {
  const tags = ['wcag2a', 'wcag2aa', 'wcag21a', 'wcag21aa', 'wcag22aa'];
  const found = await axe.run({exclude: ['.view-cube']}, {runOnly: tags,
    resultTypes: ['violations'],
    rules: {'color-contrast': {enabled: false}, 'target-size': {enabled: false}}});
  return found.violations.filter(rule => ['serious', 'critical'].includes(rule.impact))
    .flatMap(rule => rule.nodes.map(node => [rule.id, node.html.replace(/\\s+/g, ' ')]));
}
"""
"""What axe calls serious or critical: the rule, and the element as HTML.

Faces of the cube are seen at a slant, some as slivers; each has a key, which the help names.
"""
LONGEST = 120
"""Letters of an element that are told."""


def axe_script() -> str | None:
    """The source of axe-core; None where npm cannot bring it."""
    file = FOLDER / "node_modules" / "axe-core" / "axe.min.js"
    npm = shutil.which("npm")
    if not file.is_file() and npm is not None:
        FOLDER.mkdir(parents=True, exist_ok=True)
        command = [npm, "install", "--prefix", str(FOLDER), "--no-save", f"axe-core@{VERSION}"]
        try:
            subprocess.run(command, check=True, capture_output=True, timeout=FETCH_S)
        except (OSError, subprocess.SubprocessError):
            return None
    return file.read_text(encoding="utf-8") if file.is_file() else None


def axe_faults(page: Any, script: str) -> list[Fault]:
    """What axe-core finds on the page as it stands."""
    if not page.evaluate("Boolean(window.axe)"):
        page.evaluate(script)
    found = page.evaluate(RUN)
    return sorted({Fault(kind="axe", what=html[:LONGEST], more=rule) for rule, html in found})
