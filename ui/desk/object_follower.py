"""Keeps the object in the 3D view that of the state: asks a lane for its shape, draws what came.

Until the new shape is there the old one stays; while one is made only the newest request waits.
"""

from __future__ import annotations

from ui.desk.desk import Desk
from workbench.core.press.indenter import Indenter
from workbench.live.object_drawing import Drawing, DrawingCall
from workbench.live.requests import DRAWN, Request


class ObjectFollower:
    """The drawn object of one desk."""

    def __init__(self, desk: Desk) -> None:
        self.desk = desk
        self._asked: Indenter | None = None
        desk.jobs.on_preview[DRAWN] = self._show

    def follow(self) -> None:
        """Ask for the object of the state, unless it was asked last.

        Before there is a body, too: the first preview of the image keeps the lane busy for seconds.
        """
        desk, session = self.desk, self.desk.session
        indenter = session.case.indenter
        if indenter is not self._asked:
            self._asked = indenter
            call = DrawingCall(indenter=indenter)
            desk.conductor.ask(DRAWN, session.design, session.case, call)

    def _show(self, drawing: Drawing, request: Request) -> None:
        """Draw what came: along a slider all that is made on the way, else what is wanted now."""
        case = self.desk.session.case
        if request.case.indenter.kind is case.indenter.kind:
            shown = self.desk.scene.object
            shown.show(drawing, case.press)
            if request.case.indenter == case.indenter:
                self.desk.tell("object", drawing)
            self.desk.object_drawn()

    def failed(self) -> None:
        """Ask again at the next change: the worker may have been lost."""
        self._asked = None
