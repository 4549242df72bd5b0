"""Which side of the object touches: its turn, a face to click, and the question about a foot."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from typing import Any

import numpy as np
import viser

from ui.desk.desk import Desk
from workbench.core.base.errors import DesignError
from workbench.core.design.turning import Angles, touching_with
from workbench.core.press.indenter import Indenter
from workbench.live.object_drawing import Drawing

PATH = "case.indenter.turn_deg"
QUESTION = (
    "**Which side is to touch?** A flat side of this object touches the skin, and its structured "
    "side looks away."
)
WAITING = "Click the face of the object that is to touch"


class TouchingRows:
    """Rows of the object's folder."""

    def __init__(self, desk: Desk, take: Callable[[Indenter], None]) -> None:
        self.desk = desk
        self._take = take
        """Makes an object that of the state."""
        self._meant: Angles | None = None
        self._asked: Indenter | None = None
        """The object that the question is about."""
        self._kept: Any = None
        """The mesh that is to touch with its flat side: it is not asked about again."""
        self._waits = False
        """Whether the next click on the object says which face is to touch."""
        gui, guarded = desk.server.gui, desk.guarded
        hint = "About the fixed X, then Y, then Z; its side toward -Z then touches, drawn yellow"
        desk.fields.point("Turn X Y Z deg", PATH, step=15.0, hint=hint)
        hint = "Then click a face of the object in the 3D view: it is turned to the skin"
        self.pick = gui.add_button("Touch with a face", icon=viser.Icon.HAND_CLICK, hint=hint)
        self.pick.on_click(guarded(self._wait))
        self.words = gui.add_markdown("", visible=False)
        hint = "Turns the object over, as the question suggests"
        self.turn = gui.add_button("Touch with the structured side", visible=False, hint=hint)
        self.turn.on_click(guarded(self._turn))
        hint = "Leaves the object as it is, and asks no more about it"
        self.keep = gui.add_button("Keep the flat side", visible=False, hint=hint)
        self.keep.on_click(guarded(self._keep))

    def show(self, drawing: Drawing) -> None:
        """Ask about the object that has just been drawn, if its foot touches."""
        now = self.desk.session.case.indenter
        if self._waits:
            # Its nodes may be new.
            self._listen()
        if drawing.meant is None or now.mesh is None or now.mesh is self._kept:
            return
        self._meant, self._asked = drawing.meant, now
        self.refresh()
        self.desk.reports.notify(
            "The flat side of the object touches", "see the question in the folder Object"
        )

    def refresh(self) -> None:
        """Ask, unless the object is another by now."""
        if self._asked is not self.desk.session.case.indenter:
            self._asked = None
        asks = self._asked is not None
        words = QUESTION if asks else WAITING
        if (asks or self._waits) and self.words.content != words:
            self.words.content = words
        for widget, shown in (
            (self.words, asks or self._waits),
            (self.turn, asks),
            (self.keep, asks),
        ):
            if widget.visible != shown:
                widget.visible = shown

    def _turn(self, event: Any) -> None:
        now = self.desk.session.case.indenter
        if self._meant is not None and self._asked is now:
            self._turned(self._meant)

    def _keep(self, event: Any) -> None:
        self._kept, self._asked = self.desk.session.case.indenter.mesh, None
        self.refresh()

    def _wait(self, event: Any) -> None:
        """Wait for a click on the object, or no longer."""
        if self.desk.scene.object.node is None:
            raise DesignError(
                "there is no object in the 3D view yet",
                hint="press again once it is drawn",
                at="indenter.turn_deg",
            )
        self._waits = not self._waits
        self._listen()
        self.refresh()

    def _listen(self) -> None:
        clicked = self.desk.guarded(self._clicked) if self._waits else None
        self.desk.scene.object.await_click(clicked)

    def _clicked(self, normal: np.ndarray) -> None:
        """Turn the face that was clicked to the skin."""
        self._waits = False
        self._listen()
        self._turned(touching_with(self.desk.session.case.indenter.turn_deg, normal))

    def _turned(self, turn_deg: Angles) -> None:
        now = self.desk.session.case.indenter
        self._take(dataclasses.replace(now, turn_deg=turn_deg))
        self.desk.fields.refresh()
        words = ", ".join(f"{angle:g}" for angle in turn_deg)
        self.desk.log(f"the object is turned by {words} degrees")
