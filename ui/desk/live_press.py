"""Live pressing: while it is on, every change of object, place or depth is solved at once.

The desk tells it of changes; it asks the conductor, where the newest request wins, and shows what
settled. Nothing of it is stored: *Run press* computes the whole path.
"""

from __future__ import annotations

import numpy as np

from ui.desk.desk import Desk
from ui.scene.gizmo import Gizmo
from workbench.live.live_press import LiveCall, PressPreview, live_call
from workbench.live.requests import LIVE, Request


class LivePressFollower:
    """The live press of one desk."""

    def __init__(self, desk: Desk) -> None:
        self.desk = desk
        self.gizmo = Gizmo(desk.scene.api, self._dragged, edits=desk.editor.edits)
        self._asked: LiveCall | None = None
        desk.gizmos.append(self.gizmo)
        desk.jobs.on_preview[LIVE] = self._show

    def switch(self, on: bool) -> None:
        """Begin or end to follow changes."""
        self.desk.live = on
        self._asked = None
        self.gizmo.show(on)
        if on:
            self.desk.live_said("solving")
            self.follow()
            return
        self.desk.live_said("")
        self.desk.conductor.stop_live()
        self.desk.scene.clear_frames()
        self.desk.shown_results.forget("press", "shoot")
        self.desk.changed()

    def follow(self) -> None:
        """Ask for the state as it stands, unless that was asked last."""
        session = self.desk.session
        call = live_call(session.design, session.case)
        self.place_gizmo()
        if call != self._asked:
            self._asked = call
            self.desk.live_said("solving")
            self.desk.conductor.press_live(session.design, session.case)

    def _show(self, preview: PressPreview, request: Request) -> None:
        """Show a frame that settled, unless the sensor is another by now."""
        desk = self.desk
        if not self.desk.live or request.design != desk.session.design:
            return
        mesh = desk.session.result("mesh")
        if mesh is None:
            return
        desk.scene.show_live(mesh.outer, preview.contact)
        self.place_gizmo()
        desk.tell("live", preview)
        force_N = float(preview.contact.normal_N[-1])
        self.desk.live_said(
            f"**{force_N:.3f} N** along the normal · settled in {preview.seconds:.2f} s "
            f"({preview.way}, {preview.contact.substeps} substeps)"
        )

    def place_gizmo(self) -> None:
        """Put the handle where the object stands."""
        self.gizmo.place(self.desk.scene.object.standing[:3])

    def object_drawn(self) -> None:
        """The handle stands where the object does; out of sight it waits for the next switch."""
        if self.desk.live:
            self.place_gizmo()

    def failed(self) -> None:
        """Take back what is said of a request that did not settle."""
        self._asked = None
        self.desk.live_said("not solved: see the message")

    def _dragged(self, place_mm: np.ndarray, wxyz: np.ndarray) -> None:
        """Aim at the skin nearest to where the handle was dragged."""
        desk = self.desk
        place = desk.scene.body.place_near((place_mm[0], place_mm[1], place_mm[2]))
        if not self.desk.live or place is None:
            return
        x, y, z = (round(float(c), 2) for c in place.point_mm)
        desk.edit("case.press.target_mm", (x, y, z))
        desk.fields.refresh()
