"""*Dimensions*: the main sizes drawn beside the body, and dragged there as by their sliders."""

from __future__ import annotations

from typing import Any

import numpy as np

from ui.desk.desk import Desk
from ui.scene.dimension_lines import DimensionLines
from workbench.edit.dimensions import Dimension, dimensions


class DrawnSizes:
    """A check box, and the lines that it shows while the sensor is on show."""

    def __init__(self, desk: Desk) -> None:
        self.desk = desk
        hint = "Sizes drawn beside the body: drag an orange arrow (D); one drag is one step of undo"
        self.box = desk.server.gui.add_checkbox("Dimensions", True, hint=hint)
        self.box.on_update(desk.guarded(lambda event: self.refresh()))
        command = desk.server.gui.add_command("Dimensions on or off", hotkey="D")
        command.on_trigger(desk.guarded(self._toggle))
        self.lines = DimensionLines(desk.scene.api, self._moved, edits=desk.editor.edits)
        self.covered = False
        """Whether parts or the edges of a mesh are looked at."""
        self.compared = False
        """Whether other designs stand beside the sensor."""
        self._shown: tuple[Dimension, ...] = ()
        """What was drawn last: the same is not sent again."""
        self._began: tuple[Dimension, float] | None = None
        """The line that is dragged, and the value that it began with."""
        desk.on_turn.append(self.lines.turn)

    def _toggle(self, event: Any) -> None:
        self.box.value = not self.box.value
        self.refresh()

    def refresh(self) -> None:
        """Draw the sizes of the design as it stands."""
        desk = self.desk
        shown = bool(self.box.value) and not self.covered and not self.compared
        there = dimensions(desk.session.design) if shown else ()
        # Sliders of another family come with its body.
        found = tuple(line for line in there if desk.fields.has(f"design.{line.field}"))
        if found == self._shown:
            return
        self._shown = found
        low, high = desk.scene.body.bounds_mm
        size_mm = float(np.linalg.norm(high - low))
        with desk.server.atomic():
            self.lines.show([(line, self._words(line)) for line in found], size_mm)

    def show(self, stage: str, result: Any) -> None:
        """Follow the size of a new body; make room for what else is looked at."""
        if stage == "covered":
            self.covered = bool(result)
        elif stage == "compared":
            self.compared = bool(result)
        elif stage == "build":
            self._shown = ()
        if stage in ("build", "covered", "compared"):
            self.refresh()

    def _words(self, line: Dimension) -> str:
        """Name and value as its slider has them."""
        path = f"design.{line.field}"
        label = self.desk.fields.widget(path).label
        name = label.removesuffix(" mm")
        return f"{name} {self.desk.read(path):g}{label.removeprefix(name)}"

    def _moved(self, line: Dimension, gone_mm: float, held: bool) -> None:
        """Give a field the value that puts its end under the mouse, as far as its slider goes."""
        desk, path = self.desk, f"design.{line.field}"
        if self._began is None or self._began[0] is not line:
            self._began = line, float(desk.read(path))
        slider = desk.fields.widget(path)
        wanted = self._began[1] + line.per_mm * gone_mm
        steps = round((wanted - slider.min) / slider.step)
        value = round(slider.min + steps * slider.step, 6)
        desk.session.hold(path)
        desk.edit(path, min(max(value, slider.min), slider.max))
        desk.fields.refresh()
        if not held:
            desk.session.hold("")
            self._began = None
