"""A page of the browser: a folder of `ui.panels` with `page.py` and `help.md`.

`PAGE` in `page.py` says what it is; `help.md` is the sheet behind its help button.
"""

from __future__ import annotations

import importlib
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ui.desk.desk import Desk, Panel
from workbench.core.base.records import folders


@dataclass(frozen=True, kw_only=True, slots=True)
class Page:
    """One page."""

    place: int
    """From the left."""
    label: str
    build: Callable[[Desk], Panel] | None = None
    """Lays out its widgets as a tab; None: it stands in a dock of its own."""


@dataclass(frozen=True, kw_only=True, slots=True)
class PageFolder:
    """A page and its sheet."""

    page: Page
    help: str
    """Markdown."""


def pages() -> dict[str, PageFolder]:
    """All pages by label, from the left; those in docks of their own last."""
    found = []
    for folder in folders("ui.panels"):
        if (folder / "page.py").is_file():
            module: Any = importlib.import_module(f"ui.panels.{folder.name}.page")
            found.append(PageFolder(page=module.PAGE, help=_sheet(folder, module)))
    found.sort(key=lambda one: (one.page.build is None, one.page.place))
    return {one.page.label: one for one in found}


def _sheet(folder: Path, module: Any) -> str:
    """What stands in `help.md`, or else what the file says of itself."""
    sheet = folder / "help.md"
    return sheet.read_text(encoding="utf-8") if sheet.is_file() else str(module.__doc__)
