"""For simulators: the design as a pack for `wb.Sensor`, made in the workers and downloaded."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Any

import viser

from ui.desk.desk import Desk
from ui.page.plain import plain
from workbench.core.base.errors import Cancelled, DesignError
from workbench.core.base.units import human_seconds
from workbench.live.requests import Finished
from workbench.sensor.calls import WritePack
from workbench.sensor.making import packed_design

JOB = "sensor pack"
WIDTH_PX, LEAST_PX = 320, 16
"""Width of a pack's images as offered, and the least."""
BEGINS = "Begins: light, how the skin gives, and three presses; minutes for a new design."


class SensorPack:
    """Widgets of the folder."""

    def __init__(self, desk: Desk) -> None:
        self.desk = desk
        self._made: Path | None = None
        gui = desk.server.gui
        with gui.add_folder("For simulators", expand_by_default=False):
            hint = "Width of its images; narrower ones are faster and smaller"
            self.width = gui.add_number("Pack image px", WIDTH_PX, step=16, min=LEAST_PX, hint=hint)
            hint = "All that wb.Sensor.load needs, for a simulator's or a robot's loop"
            make = gui.add_button("Make sensor pack", icon=viser.Icon.PACKAGE, hint=hint)
            make.on_click(desk.guarded(self._make))
            desk.reports.beside(JOB)
            self.words = gui.add_markdown("")
            hint = "Unpack it where the simulator runs"
            self.download = gui.add_button(
                "Download pack (zip)", icon=viser.Icon.DOWNLOAD, visible=False, hint=hint
            )
            self.download.on_click(desk.guarded(self._send))
        desk.jobs.on_preview[JOB] = lambda found, request: self._take(found)

    def _make(self, event: Any) -> None:
        desk = self.desk
        desk.reports.begin()
        desk.fields.read_typed(now=True)
        width_px, state = int(self.width.value), desk.session.state
        call = WritePack(
            design=state.design, project=desk.session.project.folder, width_px=width_px
        )
        shown = dataclasses.replace(state, design=packed_design(state.design, width_px))
        self.words.content, self.download.visible = BEGINS, False
        desk.jobs.ask(JOB, call, shown, self._ended)

    def _take(self, made: Path) -> None:
        self._made, self.download.visible = made, True
        size_MB = made.stat().st_size / 1e6
        self.words.content = f"**{plain(made.stem)}**: {size_MB:.0f} MB, also in {plain(str(made))}"

    def _ended(self, finished: Finished) -> None:
        error = finished.error
        if error is None:
            self.words.content += f", in {human_seconds(finished.seconds)}"
            return
        self.words.content = "" if isinstance(error, Cancelled) else "No pack: see the message."
        if not isinstance(error, Cancelled):
            self.desk.reports.report(error, job=JOB)

    def _send(self, event: Any) -> None:
        made = self._made
        if made is None or not made.is_file():
            raise DesignError("the pack is gone", hint="press Make sensor pack again")
        event.client.send_file_download(made.name, made.read_bytes(), save_immediately=True)
