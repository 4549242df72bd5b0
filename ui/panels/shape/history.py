"""Undo and redo."""

from __future__ import annotations

from ui.desk.desk import Desk


class History:
    """Widgets below the parameters of a shape."""

    def __init__(self, desk: Desk) -> None:
        self.desk = desk
        gui = desk.server.gui
        steps = gui.add_button_group(
            "History", ("Undo", "Redo"), hint="Ctrl+Z and Ctrl+Shift+Z; a drag is one step"
        )
        steps.on_click(desk.guarded(lambda event: self._step(steps.value)))
        undo = gui.add_command("Undo", hotkey="Z", modifier="cmd/ctrl")
        undo.on_trigger(desk.guarded(lambda event: self._step("Undo")))
        redo = gui.add_command("Redo", hotkey="Z", modifier="cmd/ctrl+shift")
        redo.on_trigger(desk.guarded(lambda event: self._step("Redo")))

    def _step(self, direction: str) -> None:
        session = self.desk.session
        moved = session.undo() if direction == "Undo" else session.redo()
        if moved:
            self.desk.log(direction.lower())
            self.desk.replaced()
