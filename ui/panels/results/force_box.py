"""A force in newtons, and the depth at which the press on show reaches it."""

from __future__ import annotations

from typing import Any

from ui.desk.desk import Desk
from workbench.view.force_asked import WayIn

FIRST_N = 1.0


class ForceBox:
    """A number and what is said of it; there while there is a press."""

    def __init__(self, desk: Desk) -> None:
        gui = desk.server.gui
        self.way: WayIn | None = None
        hint = "At which depth of the press on show it is reached, and what is left of the wall"
        self.wanted = gui.add_number("Depth at N", FIRST_N, min=0.0, step=0.5, hint=hint)
        self.said = gui.add_markdown("")
        self.wanted.on_update(desk.guarded(lambda event: self._tell()))
        self.take(None)

    def take(self, way: WayIn | None) -> None:
        """Read another press; None: there is none."""
        self.way = way
        handles: tuple[Any, ...] = (self.wanted, self.said)
        for handle in handles:
            handle.visible = way is not None
        self._tell()

    def _tell(self) -> None:
        text = "" if self.way is None else self.way.words(float(self.wanted.value))
        if self.said.content != text:
            self.said.content = text
