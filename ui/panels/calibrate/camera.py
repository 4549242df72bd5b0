"""The camera: what the design expects of the idle photo, beside the idle photo."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
import viser

from ui.desk.desk import Desk
from ui.page.colours import AMBER
from ui.page.imaging import placeholder
from workbench.calibration.seen.photo_set import IDLE
from workbench.core.base.errors import Cancelled
from workbench.live.image_preview import ImagePreview, image_preview_call
from workbench.live.requests import Finished
from workbench.photographs.kept_photos import KeptPhotos
from workbench.photographs.pictures import as_large, beside, blended, sized

JOB = "expected view"
BESIDE, BLENDED = "Side by side", "On each other"
POSE = (
    "Left the photograph, right what the design expects. Rim and outline should lie alike; if not, "
    "change place, direction and lens of the camera on *Optics* and compare again."
)


class CameraFolder:
    """Widgets of the folder."""

    def __init__(self, desk: Desk, kept: KeptPhotos) -> None:
        self.desk, self.kept = desk, kept
        self.expected: np.ndarray | None = None
        gui, guarded = desk.server.gui, desk.guarded
        self.folder = gui.add_folder("Camera", expand_by_default=False, visible=False)
        with self.folder:
            self.said = gui.add_markdown("")
            hint = "Sets width and height of the design's camera; its background photo goes"
            self.size = gui.add_button("Take size of photographs", visible=False, hint=hint)
            self.size.on_click(guarded(self._take_size))
            hint = "A quick image of the design at rest, in a second or two"
            compare = gui.add_button("Compare with design", icon=viser.Icon.CAMERA, hint=hint)
            compare.on_click(guarded(self._ask))
            hint = "On each other: what does not lie alike is seen twice"
            self.view = gui.add_button_group("Compared", (BESIDE, BLENDED), hint=hint)
            self.view.on_click(guarded(lambda event: self._draw()))
            self.image = gui.add_image(placeholder(), format="jpeg", visible=False)
        desk.jobs.on_preview[JOB] = lambda found, request: self._take(found)

    def _ask(self, event: Any) -> None:
        state = self.desk.session.state
        call = image_preview_call(state.design, state.case)
        self.desk.jobs.ask(JOB, call, state, self._ended)

    def _ended(self, finished: Finished) -> None:
        if finished.error is not None and not isinstance(finished.error, Cancelled):
            self.desk.reports.report(finished.error)

    def _take(self, found: ImagePreview) -> None:
        self.expected = found.images[0]
        self._draw()

    def _draw(self) -> None:
        if self.expected is None or not self.kept.has_idle:
            return
        idle, _ = sized(self.kept.image(IDLE))
        expected = as_large(self.expected, idle)
        on_each_other = self.view.value == BLENDED
        self.image.image = (blended if on_each_other else beside)(idle, expected)
        self.image.visible = True

    def _take_size(self, event: Any) -> None:
        height, width = self.kept.image(IDLE).shape[:2]
        optics = self.desk.session.design.optics
        camera = dataclasses.replace(optics.camera, width_px=width, height_px=height)
        # Background and unit are photographs of another size.
        optics = dataclasses.replace(optics, camera=camera, background=None, unit=None)
        self.desk.session.change_optics(optics)
        self.desk.replaced()

    def refresh(self) -> None:
        """Say whether the camera has the photographs' size."""
        if not self.kept.has_idle:
            return
        height, width = self.kept.image(IDLE).shape[:2]
        camera = self.desk.session.design.optics.camera
        fits = (camera.width_px, camera.height_px) == (width, height)
        self.size.visible = not fits
        text = POSE if fits else wrong_size(camera.width_px, camera.height_px, (width, height))
        if self.said.content != text:
            self.said.content = text


def wrong_size(width_px: int, height_px: int, photos_px: tuple[int, int]) -> str:
    """That the camera and the photographs differ in size, and what to do."""
    return (
        f"<span style='color:{AMBER}'>The camera of the design has {width_px} x {height_px} "
        f"pixels, the photographs {photos_px[0]} x {photos_px[1]}. Press *Take size of "
        "photographs* and set the field of view that goes with them on *Optics*.</span>"
    )
