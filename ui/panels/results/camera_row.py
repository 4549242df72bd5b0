"""Which camera's image is on show: a row with a button for each, and a key for the next one."""

from __future__ import annotations

from ui.desk.desk import Desk
from ui.desk.signal import Signal

CHOSEN = "● "
"""Stands before the camera on show: viser's rows of buttons do not tell which one was pressed."""


class CameraRow:
    """Buttons of the cameras; seen where there are several."""

    def __init__(self, desk: Desk) -> None:
        gui, guarded = desk.server.gui, desk.guarded
        self.number = 0
        """Of the camera on show, from 0."""
        self.count = 0
        self.chosen: Signal[[]] = Signal()
        """Told when another camera is wanted."""
        self.row = gui.add_button_group(
            "Camera", ("camera 1",), visible=False, hint="Whose image is shown; N: the next one"
        )
        self.row.on_click(guarded(lambda event: self._choose(int(self.row.value.split()[-1]) - 1)))
        command = gui.add_command("Next camera's image", hotkey="N")
        command.on_trigger(guarded(lambda event: self._choose((self.number + 1) % self.count)))

    def offer(self, count: int) -> None:
        """Offer so many cameras; the one on show stays where there still is one."""
        self.count = count
        self._draw(min(self.number, count - 1))

    def hide(self) -> None:
        """There is no image to choose."""
        self.row.visible = False

    def _choose(self, number: int) -> None:
        if self.count > 1:
            self._draw(number)
            self.chosen()

    def _names(self) -> tuple[str, ...]:
        return tuple(
            f"{CHOSEN if k == self.number else ''}camera {k + 1}" for k in range(self.count)
        )

    def _draw(self, number: int) -> None:
        self.number = number
        if self.row.options != self._names():
            self.row.options = self._names()
        self.row.visible = self.count > 1
