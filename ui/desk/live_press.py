"""Live pressing: while it is on, every change of object, place or depth is solved at once.

The desk tells it of changes; it asks the conductor, where the newest request wins, and shows what
settled. Nothing of it is stored: *Run press* computes the whole path.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from ui.scene.gizmo import Gizmo
from workbench.live.live_press import LiveCall, PressPreview, live_call
from workbench.live.requests import Request

if TYPE_CHECKING:
    from ui.desk.desk import Desk


class LivePressFollower:
    """The live press of one desk."""

    def __init__(self, desk: Desk) -> None:
        self.desk = desk
        self.on = False
        self.on_message: Callable[[str], None] = lambda text: None
        """Set by the panel with the check box: shows how it goes."""
        self.gizmo = Gizmo(desk.scene.api, self._dragged, edits=desk.editor.edits)
        self._asked: LiveCall | None = None

    def switch(self, on: bool) -> None:
        """Begin or end to follow changes."""
        self.on = on
        self._asked = None
        self.gizmo.show(on)
        if on:
            self.on_message("solving")
            self.follow()
            return
        self.on_message("")
        self.desk.conductor.stop_live()
        self.desk.scene.clear_frames()
        self.desk.shown_results.forget("press", "shoot")
        self.desk.changed()

    def follow(self) -> None:
        """Ask for the state as it stands, unless that was asked last."""
        session = self.desk.session
        call = live_call(session.design, session.case)
        self.gizmo.place(self.desk.scene.object.standing[:3])
        if call != self._asked:
            self._asked = call
            self.on_message("solving")
            self.desk.conductor.press_live(session.design, session.case)

    def show(self, preview: PressPreview, request: Request) -> None:
        """Show a frame that settled, unless the sensor is another by now."""
        desk = self.desk
        if not self.on or request.design != desk.session.design:
            return
        mesh = desk.session.result("mesh")
        if mesh is None:
            return
        desk.scene.show_live(mesh.outer, preview.contact)
        self.gizmo.place(desk.scene.object.standing[:3])
        desk.tell("live", preview)
        force_N = float(preview.contact.normal_N[-1])
        self.on_message(
            f"**{force_N:.3f} N** along the normal · settled in {preview.seconds:.2f} s "
            f"({preview.way}, {preview.contact.substeps} substeps)"
        )

    def failed(self) -> None:
        """Take back what is said of a request that did not settle."""
        self._asked = None
        self.on_message("not solved: see the message")

    def _dragged(self, place_mm: np.ndarray, wxyz: np.ndarray) -> None:
        """Aim at the skin nearest to where the handle was dragged."""
        desk = self.desk
        place = desk.scene.body.place_near((place_mm[0], place_mm[1], place_mm[2]))
        if not self.on or place is None:
            return
        x, y, z = (round(float(c), 2) for c in place.point_mm)
        desk.edit("case.press.target_mm", (x, y, z))
        desk.fields.refresh()
