"""Search: what is looked for, the search as it runs, the best designs."""

from __future__ import annotations

from typing import Any

from ui.desk.desk import Desk
from ui.panels.page import Page
from ui.panels.search.form import FormFolder
from ui.panels.search.outcome import OutcomeFolder
from ui.panels.search.running import RunFolder
from workbench.search.kept_searches import Standing


class SearchPanel:
    """Widgets of the tab."""

    def __init__(self, desk: Desk) -> None:
        self.form = FormFolder(desk)
        self.run = RunFolder(desk, self.form.asked, self._changed)
        self.outcome = OutcomeFolder(desk)

    def _changed(self, name: str, found: Standing) -> None:
        """Another search is on show, or it has more trials."""
        self.outcome.load(name, found)

    def refresh(self) -> None:
        """Follow the design: what may vary."""
        self.form.refresh()

    def show(self, stage: str, result: Any) -> None:
        """Nothing here follows results of the design."""


PAGE = Page(place=6, label="Search", build=SearchPanel)
