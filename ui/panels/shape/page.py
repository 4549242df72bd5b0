"""Shape: where to start from, undo, the family's own parameters, the layers and the material."""

from __future__ import annotations

from typing import Any

from ui.desk.desk import Desk
from ui.page.callbacks import put
from ui.panels.page import Page
from ui.panels.shape.design_files import DesignFiles
from ui.panels.shape.drawn_sizes import DrawnSizes
from ui.panels.shape.intake import IntakeFolder
from ui.panels.shape.material import MaterialFolder
from ui.panels.shape.start_page import StartPage
from workbench.edit.forms import choices, family, load_design, purpose, sliders
from workbench.project.state import State
from workbench.variants.comparison import parameter_differences

MOST_TOLD = 3
"""Parameters that a step of undo names."""
OWN = "own design"
"""Shown when the design is no longer one of the list."""


class ShapePanel:
    """Widgets of the first tab."""

    def __init__(self, desk: Desk) -> None:
        self.desk = desk
        gui = desk.server.gui
        self.start = gui.add_dropdown(
            "Start from",
            self._offered(),
            initial_value=self._origin(),
            hint="Replaces the whole design; Undo brings yours back",
        )
        self.start.on_update(desk.guarded(self._start_from))
        self.about = gui.add_markdown("")
        self.files = DesignFiles(desk)
        StartPage(desk, self.files)
        self.files.gallery_button()
        self.files.name_widgets()
        self._history()
        self.sizes = DrawnSizes(desk)
        self.folder = gui.add_folder("Body")
        self.family = ""
        self._fill()
        with gui.add_folder("Layers"):
            self._layers()
        self.material = MaterialFolder(desk)
        with gui.add_folder("Own body (STEP or STL)", expand_by_default=False):
            self.intake = IntakeFolder(desk)
        self.files.file_widgets()
        self._tell_about()

    def _history(self) -> None:
        desk, gui = self.desk, self.desk.server.gui
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
        before = session.state
        moved = session.undo() if direction == "Undo" else session.redo()
        if moved:
            words = _stepped(before, session.state)
            self.desk.log(f"{direction.lower()}: {words}")
            self.desk.reports.notify(direction, words)
            self.desk.replaced()

    def _layers(self) -> None:
        fields = self.desk.fields
        span, hint = (0.8, 6.0, 0.1), "Soft sensing wall"
        fields.slider("Elastomer mm", "design.layers.elastomer_mm", span=span, hint=hint)
        span, hint = (0.4, 5.0, 0.1), "Rigid clear shell or plate"
        fields.slider("Support mm", "design.layers.support_mm", span=span, hint=hint)

    def _fill(self) -> None:
        """Sliders of the family; made anew when the family changes."""
        desk = self.desk
        name = desk.session.design.family
        if name == self.family:
            return
        self.family = name
        desk.fields.forget("design.shape.")
        self.folder.label = f"Body: {family(name).title}"
        with self.folder:
            for slider in sliders(name):
                source = f" (source: {slider.source})" if slider.source else ""
                desk.fields.slider(
                    f"{slider.label} {slider.unit}".strip(),
                    f"design.shape.{slider.name}",
                    span=(slider.minimum, slider.maximum, slider.step),
                    hint=slider.hint + source,
                )

    def _origin(self) -> str:
        """The entry of the list that the design came from, as far as its name tells."""
        name = self.desk.session.design.name
        return name if name in choices() else OWN

    def _offered(self) -> tuple[str, ...]:
        """All one can start from; a design of one's own only names where one is."""
        return (*choices(), OWN) if self._origin() == OWN else choices()

    def _start_from(self, event: Any) -> None:
        if event.client is not None and self.start.value != OWN:
            self.desk.session.replace_design(load_design(self.start.value))
            self.files.forget()
            self.desk.replaced()

    def _tell_about(self) -> None:
        origin = self._origin()
        parts = ("" if origin == OWN else f"*{purpose(origin)}*", self.desk.scene.body.tints())
        text = "\n\n".join(part for part in parts if part)
        if self.about.content != text:
            self.about.content = text

    def refresh(self) -> None:
        """Show the state as it stands."""
        self._fill()
        self.intake.refresh()
        origin, offered = self._origin(), self._offered()
        if origin not in self.start.options:
            self.start.options = offered
        put(self.start, origin)
        if tuple(self.start.options) != offered:
            self.start.options = offered
        self._tell_about()
        self.files.refresh()
        self.material.refresh()
        self.sizes.refresh()

    def show(self, stage: str, result: Any) -> None:
        """An imported body's faces can be picked once it is built."""
        self.intake.show(stage, result)
        self.sizes.show(stage, result)
        if stage == "build":
            self._tell_about()


PAGE = Page(place=1, label="Shape", build=ShapePanel)


def _stepped(before: State, after: State) -> str:
    """What a step of undo or redo has changed, in words."""
    found = parameter_differences(before, after)
    words = [f"{row.label} {row.a} → {row.b} {row.unit}" for row in found]
    more = f"; {len(words) - MOST_TOLD} more" if len(words) > MOST_TOLD else ""
    return "; ".join(word.rstrip() for word in words[:MOST_TOLD]) + more
