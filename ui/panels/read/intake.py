"""Photographs to read: the sensor with nothing on it, and touched; from files or a camera."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import viser

from ui.desk.desk import Desk
from ui.page.colours import AMBER
from workbench.core.base.errors import DesignError
from workbench.photographs.kept_photos import KeptPhotos
from workbench.photographs.photo_files import unpacked_upload
from workbench.reading.kept_readings import KeptReadings

EMPTY = (
    "Photograph the sensor you built with nothing on it, as `idle.png`, and touched: what touches "
    "it is read from the difference, by the light of this design."
)


class ReadIntake:
    """Widgets at the top of the page."""

    def __init__(self, desk: Desk, kept: KeptReadings, on_arrived: Callable[[], None]) -> None:
        self.desk, self.kept = desk, kept
        self.on_arrived = on_arrived
        gui, guarded = desk.server.gui, desk.guarded
        self.said = gui.add_markdown(EMPTY)
        hint = "A zip with idle.png and photographs of touch, or one picture after the other, the "
        hint += "one with nothing on the sensor named idle"
        self.upload = gui.add_upload_button(
            "Load photos to read",
            mime_type=".zip,.png,.jpg,.jpeg,.bmp,.tif,.tiff",
            icon=viser.Icon.UPLOAD,
            hint=hint,
        )
        self.upload.on_upload(desk.reports.received(self._sent, self._take))
        hint = "The one that the sensor was calibrated with, if nothing has changed since"
        self.borrow = gui.add_button("Idle photo of Calibrate", hint=hint)
        self.borrow.on_click(guarded(self._borrow))
        hint = "The set is kept beside in the project's folder"
        self.away = gui.add_button("Put photos to read away", visible=False, hint=hint)
        self.away.on_click(guarded(self._put_away))

    def _sent(self) -> Mapping[str, bytes]:
        """What was uploaded, unpacked without the desk's lock."""
        sent = self.upload.value
        return unpacked_upload(sent.name, sent.content, hint="load it in two parts")

    def _take(self, files: Mapping[str, bytes]) -> None:
        came = self.kept.take(files)
        self.desk.log(f"{len(came)} photographs to read taken of {len(files)} files")
        self.on_arrived()

    def _borrow(self, event: Any) -> None:
        calibrated = KeptPhotos(self.desk.session.project.folder)
        if not calibrated.has_idle:
            raise DesignError(
                "the page Calibrate has no idle photo", hint="load one here, named idle.png"
            )
        self.kept.take({"idle.png": (calibrated.folder / "idle.png").read_bytes()})
        self.on_arrived()

    def _put_away(self, event: Any) -> None:
        where = self.kept.put_away()
        if where is not None:
            self.desk.reports.notify("Put away", f"The photographs are kept in {where.name}")
        self.on_arrived()

    def refresh(self) -> None:
        """Say what is there and what is missing."""
        count, idle = len(self.kept.photos), self.kept.has_idle
        self.away.visible = bool(count) or idle
        self.borrow.visible = not idle
        if not count and not idle:
            words = EMPTY
        else:
            rest = " and the idle photo. " if idle else ". "
            words = f"**{count}** photographs of touch{rest}"
            if not idle:
                lacks = "Load also the sensor with nothing on it, named idle.png."
                words += f"<span style='color:{AMBER}'>{lacks}</span>"
        self.said.content = words
