"""The image preview that follows the sliders while the tactile image is stale.

The desk tells it of every change; it asks the conductor, where the newest request waits for the
running one, and hands what came to the panels as `image_preview`. What a press has rendered is
never covered by it: once the state has images, they are shown instead. While a shape is built, the
preview on show is of the one before, and is said to be.
"""

from __future__ import annotations

from ui.desk.desk import Desk
from workbench.live.image_preview import ImagePreview, ImagePreviewCall, image_preview_call
from workbench.live.requests import IMAGE_PREVIEW, Request


class ImagePreviewFollower:
    """The image preview of one desk."""

    def __init__(self, desk: Desk) -> None:
        self.desk = desk
        self._asked: ImagePreviewCall | None = None
        self._shown: ImagePreviewCall | None = None
        """What the preview on show was asked for; None while there is none."""
        desk.jobs.on_preview[IMAGE_PREVIEW] = self._show

    def follow(self) -> None:
        """Ask for the state as it stands, unless it has images or was asked last."""
        desk, session = self.desk, self.desk.session
        if desk.live or desk.current("shoot"):
            self._asked = self._shown = None
            desk.conductor.give_up(IMAGE_PREVIEW)
            return
        call = image_preview_call(session.design, session.case)
        if call != self._asked:
            self._asked = call
            desk.conductor.ask(IMAGE_PREVIEW, session.design, session.case, call)
        self._date()

    def _date(self) -> None:
        """Tell whether the preview on show has the shape of the state."""
        if self._shown is not None and self._asked is not None:
            self.desk.tell("image_preview_of_shape", self._shown.solid == self._asked.solid)

    def _show(self, preview: ImagePreview, request: Request) -> None:
        """Show what came, unless images have come meanwhile or the design is another one."""
        desk = self.desk
        other = request.design.family != desk.session.design.family
        if other or desk.live or desk.current("shoot"):
            return
        # A step back to a state that has images shows them again.
        desk.shown_results.forget("shoot")
        desk.tell("image_preview", preview)
        if isinstance(request.preview, ImagePreviewCall):
            self._shown = request.preview
        self._date()

    def failed(self) -> None:
        """Take the preview of an earlier state away: it would pass for one of this state."""
        self._asked = self._shown = None
        if not self.desk.live and not self.desk.current("shoot"):
            self.desk.tell("image_preview", None)
