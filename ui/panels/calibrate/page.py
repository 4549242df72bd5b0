"""Calibrate: photographs of the built sensor, their contacts, the fit, the design that comes."""

from __future__ import annotations

from typing import Any

from ui.desk.desk import Desk
from ui.panels.calibrate.camera import CameraFolder
from ui.panels.calibrate.contacts import ContactsFolder
from ui.panels.calibrate.intake import PhotoIntake
from ui.panels.calibrate.outcome import OutcomeFolder
from ui.panels.calibrate.running import RunFolder
from ui.panels.page import Page
from workbench.photographs.kept_photos import KeptPhotos


class CalibratePanel:
    """Widgets of the tab."""

    def __init__(self, desk: Desk) -> None:
        self.desk = desk
        self.kept = KeptPhotos(desk.session.project.folder)
        self.intake = PhotoIntake(desk, self.kept, self._arrived)
        self.contacts = ContactsFolder(desk, self.kept, self._corrected)
        self.camera = CameraFolder(desk, self.kept)
        self.run = RunFolder(desk, self.kept, self._calibrated)
        self.outcome = OutcomeFolder(desk, self.kept)
        self._follow()

    def _follow(self) -> None:
        there = bool(self.kept.photos) or self.kept.has_idle
        self.contacts.folder.visible = self.kept.has_idle and bool(self.kept.photos)
        self.camera.folder.visible = self.kept.has_idle
        self.run.folder.visible = there
        self.intake.refresh()
        self.contacts.refresh()
        self.camera.refresh()
        self.run.refresh()
        self.outcome.refresh()

    def _arrived(self) -> None:
        """Photographs have come, or were put away: look for the contacts that are not known."""
        self._follow()
        self.contacts.find()

    def _corrected(self) -> None:
        """A contact, or what a photograph is for, has changed."""
        self.intake.refresh()
        self.run.refresh()
        self.outcome.refresh()

    def _calibrated(self) -> None:
        """A calibration has ended."""
        self.outcome.refresh()

    def refresh(self) -> None:
        """Follow the design: its camera."""
        self.camera.refresh()
        self.run.refresh()

    def show(self, stage: str, result: Any) -> None:
        """Nothing here follows results of the design."""


PAGE = Page(place=7, label="Calibrate", build=CalibratePanel)
