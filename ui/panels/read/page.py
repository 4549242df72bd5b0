"""Read: photographs of the built sensor as depth, contact and force, on the skin and in figures."""

from __future__ import annotations

from typing import Any

from ui.desk.desk import Desk
from ui.panels.page import Page
from ui.panels.read.intake import ReadIntake
from ui.panels.read.outcome import WAY, ReadOutcome
from ui.panels.read.running import ReadRun
from workbench.reading.kept_readings import KeptReadings


class ReadPanel:
    """Widgets of the tab."""

    def __init__(self, desk: Desk) -> None:
        self.kept = KeptReadings(desk.session.project.folder)
        self.intake = ReadIntake(desk, self.kept, self._arrived)
        self.run = ReadRun(desk, self.kept, self._arrived)
        self.outcome = ReadOutcome(desk)
        self.run.on_read = self.outcome.take
        self._arrived()

    def _arrived(self) -> None:
        """Photographs have come, or were put away."""
        self.intake.refresh()
        self.run.refresh()

    def refresh(self) -> None:
        """Nothing here follows edits: each reading takes the design as it then is."""

    def show(self, stage: str, result: Any) -> None:
        """Give the 3D view back to what is asked for."""
        given = stage in ("press", "live", "partial", "build", "sensor", "run")
        if given or (stage == "mapped" and result != WAY):
            self.outcome.hide()


PAGE = Page(place=8, label="Read", build=ReadPanel)
