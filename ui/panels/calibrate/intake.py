"""Putting photographs in: an archive, single pictures, or a folder of the project.

What comes is read and checked as a whole: a file that does not fit leaves the set as it was.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping
from typing import Any

import viser

from ui.desk.desk import Desk
from ui.page.colours import AMBER
from workbench.calibration.seen.photo_set import FEWEST, LARGEST_BALL_MM, SMALLEST_BALL_MM
from workbench.photographs.kept_photos import KeptPhotos, Use
from workbench.photographs.photo_files import folder_files, unpacked_upload

EMPTY = (
    "Photograph the sensor you built, once with nothing on it and 10 to 20 times with a ball "
    "pressed into it, and the images here will look like its own."
)
BALL_MM = 6.0
"""Diameter until one is typed."""


class PhotoIntake:
    """Widgets at the top of the page."""

    def __init__(self, desk: Desk, kept: KeptPhotos, on_arrived: Callable[[], None]) -> None:
        self.desk, self.kept = desk, kept
        self.on_arrived = on_arrived
        gui, guarded = desk.server.gui, desk.guarded
        self.said = gui.add_markdown(EMPTY)
        hint = "A zip with idle.png, the photographs and, where there is one, presses.csv; "
        hint += "or one picture after the other, the one with nothing on the sensor named idle"
        self.upload = gui.add_upload_button(
            "Load photographs",
            mime_type=".zip,.png,.jpg,.jpeg,.bmp,.tif,.tiff,.csv",
            icon=viser.Icon.UPLOAD,
            hint=hint,
        )
        self.upload.on_upload(desk.reports.received(self._sent, self._take))
        self.more = gui.add_folder("Ball and photographs", visible=False)
        with self.more:
            hint = "Diameter, of all photographs; presses.csv may say others"
            self.ball = gui.add_number("Ball mm", BALL_MM, step=0.1, hint=hint)
            self.ball.min, self.ball.max = SMALLEST_BALL_MM, LARGEST_BALL_MM
            self.ball.on_update(guarded(self._resize))
            hint = "The set is kept beside in the project's folder"
            away = gui.add_button("Begin with other photographs", hint=hint)
            away.on_click(guarded(self._put_away))
        with gui.add_folder("From a folder", expand_by_default=False):
            hint = f"Of the project, which is {kept.root.parent}"
            self.typed = gui.add_text("Folder", "", hint=hint)
            hint = "Copies the photographs and presses.csv of the folder typed above"
            take = gui.add_button("Take photographs of folder", hint=hint)
            take.on_click(guarded(self._take_folder))

    def _sent(self) -> Mapping[str, bytes]:
        """What was uploaded, unpacked without the desk's lock."""
        sent = self.upload.value
        hint = "load it in two parts, or copy it into the project and use From a folder"
        return unpacked_upload(sent.name, sent.content, hint=hint)

    def _take_folder(self, event: Any) -> None:
        self._take(folder_files(self.kept.root.parent, self.typed.value))

    def _take(self, files: Mapping[str, bytes]) -> None:
        self.desk.reports.settle()
        came = self.kept.take(files, float(self.ball.value))
        self.desk.log(f"{len(came)} photographs taken of {len(files)} files")
        self.on_arrived()

    def _resize(self, event: Any) -> None:
        if event.client is not None:
            ball_mm = float(self.ball.value)
            self.kept.put(*(dataclasses.replace(e, ball_mm=ball_mm) for e in self.kept.photos))
            self.on_arrived()

    def _put_away(self, event: Any) -> None:
        where = self.kept.put_away()
        if where is not None:
            self.desk.reports.notify("Put away", f"The photographs are kept in {where.name}")
        self.on_arrived()

    def refresh(self) -> None:
        """Say what is there and what is missing."""
        photos = self.kept.photos
        self.more.visible = bool(photos) or self.kept.has_idle
        balls = {each.ball_mm for each in photos}
        if len(balls) == 1:
            self.ball.value = balls.pop()
        self.said.content = words(self.kept)


def words(kept: KeptPhotos) -> str:
    """What a set holds, and what it lacks."""
    photos = kept.photos
    if not photos and not kept.has_idle:
        return EMPTY
    uses = {use: sum(each.use is use for each in photos) for use in Use}
    line = f"**{len(photos)}** photographs of balls"
    held, left = uses[Use.HOLD], uses[Use.LEAVE]
    line += f", {held} held out" * bool(held) + f", {left} left out" * bool(left) + ". "
    lacks = []
    if not kept.has_idle:
        lacks.append("Load also the sensor with nothing on it, named idle.png.")
    if uses[Use.FIT] < FEWEST:
        lacks.append(f"At least {FEWEST} are needed to fit to, 10 to 20 are good.")
    return line + f"<span style='color:{AMBER}'>{' '.join(lacks)}</span>" * bool(lacks)
