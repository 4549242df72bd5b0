"""The tree of parts: which are on show in the 3D view, and how far apart."""

from __future__ import annotations

from typing import Any

import viser

from ui.desk.desk import Desk
from ui.page.player import Player
from workbench.core.result.fabrication import FabricationPart, PartGroup, PartMotion
from workbench.view.part_words import part_label

FRAMES = 50
"""Steps in which the mould is opened by itself: four seconds."""
OPEN = viser.Icon.PLAYER_PLAY
TITLES = {PartGroup.MOULD: "Mould parts", PartGroup.SENSOR: "Sensor parts"}


class Opening:
    """The exploded view as frames, for the player."""

    max = FRAMES

    def __init__(self, spread: Any) -> None:
        self.spread = spread

    @property
    def value(self) -> int:
        """Frame on show."""
        return round(FRAMES * self.spread.value)

    @value.setter
    def value(self, frame: int) -> None:
        self.spread.value = frame / FRAMES


class PartsTree:
    """One check box for each part, one for each group, one for all, and the exploded view."""

    def __init__(self, desk: Desk) -> None:
        self.desk = desk
        gui = desk.server.gui
        hint = "In place of the sensor"
        self.view = gui.add_checkbox("Show parts", False, visible=False, hint=hint)
        self.view.on_update(desk.guarded(lambda event: self._view()))
        hint = "How far the mould is opened, one part after another, as the recipe says"
        step = 1.0 / FRAMES
        self.spread = gui.add_slider("Explode", 0.0, 1.0, step, 1.0, visible=False, hint=hint)
        self.spread.on_update(desk.guarded(self._moved))
        self.player = Player(Opening(self.spread))
        hint = "Open the mould, motion by motion"
        self.play = gui.add_button("Play opening", icon=OPEN, visible=False, hint=hint)
        self.play.on_click(desk.guarded(lambda event: self._play()))
        self.folder = gui.add_folder("Parts", visible=False)
        self.back = gui.add_panel(visible=False)
        with self.back.add_tab("Parts on show"):
            hint = "Put the parts away: they stand in place of the sensor"
            button = gui.add_button("Back to the sensor", icon=viser.Icon.ARROW_BACK_UP, hint=hint)
            button.on_click(desk.guarded(lambda event: self.put_away()))
        self.back.float(x=405, y=-15, width=220)
        self.boxes: dict[str, Any] = {}
        self.groups: dict[PartGroup, Any] = {}
        self.parts: tuple[FabricationPart, ...] = ()
        self.closed: list[Any] = []

    def offer(
        self, parts: tuple[FabricationPart, ...], motions: tuple[PartMotion, ...] = ()
    ) -> None:
        """Take the parts of another design; those of the mould are ticked.

        Args:
            motions: How the mould is opened, for the exploded view.
        """
        shown = self.view.value
        if not parts:
            self.put_away()
        self.parts = parts
        for handle in self.closed:
            handle.remove()
        self.closed, self.boxes, self.groups = [], {}, {}
        for handle in (self.view, self.spread, self.play, self.folder):
            handle.visible = bool(parts)
        for group, title in TITLES.items():
            members = [part for part in parts if part.group is group]
            if members:
                self._add_group(group, title, members)
        self.desk.scene.parts.load(parts, motions)
        if shown and parts:
            self._show()

    def _add_group(self, group: PartGroup, title: str, members: list[FabricationPart]) -> None:
        gui, ticked = self.desk.server.gui, group is PartGroup.MOULD
        with self.folder:
            folder = gui.add_folder(title)
        self.closed.append(folder)
        with folder:
            every = gui.add_checkbox(f"All {title.lower()}", ticked, hint="On show or not")
            every.on_update(self.desk.guarded(lambda event: self._tick_group(group, event)))
            self.groups[group] = every
            for part in members:
                hint = f"{part.process}; its files are named {part.name}"
                box = gui.add_checkbox(part_label(part.name), ticked, hint=hint)
                box.on_update(self.desk.guarded(self._ticked))
                self.boxes[part.name] = box

    def _tick_group(self, group: PartGroup, event: Any) -> None:
        if event.client is not None:
            for part in self.parts:
                if part.group is group:
                    self.boxes[part.name].value = self.groups[group].value
            self._bring_or_show()
            self._back_off()

    def _ticked(self, event: Any) -> None:
        if event.client is not None:
            self._bring_or_show()
            self._back_off()

    def _moved(self, event: Any) -> None:
        self._show()
        if event.client is not None:
            self.player.stop()
            self._back_off()

    def _play(self) -> None:
        self.bring_out()
        self.spread.value = 0.0
        self.player.start()

    def _back_off(self) -> None:
        """An eye that flew to a place would stand inside parts that come or move."""
        scene = self.desk.scene
        if self.view.value and scene.views.close and scene.parts.shown:
            scene.views.step_back(*scene.parts.bounds_mm())

    def _bring_or_show(self) -> None:
        if self.view.value:
            self._show()
        else:
            self.bring_out()

    def reveal(self, name: str) -> None:
        """Make sure that a part is on show; without one of that name, the sensor itself."""
        if name not in self.boxes:
            self.put_away()
            return
        self.boxes[name].value = True
        self._bring_or_show()

    def bring_out(self) -> None:
        """Show the ticked parts in place of the sensor."""
        if self.view.value:
            self._show()
        else:
            self.view.value = True

    def put_away(self) -> None:
        """Show the sensor again."""
        if self.view.value:
            self.view.value = False

    def _view(self) -> None:
        scene = self.desk.scene
        scene.marks.clear_cell()
        if self.view.value and self.parts:
            scene.show_sensor(False)
            self._show()
            if scene.parts.shown:
                scene.views.step_back(*scene.parts.bounds_mm())
        else:
            scene.parts.show(set(), self.spread.value)
            scene.show_sensor(True)
            scene.views.step_forward(*scene.body.bounds_mm)
        shown = bool(self.view.value and self.parts)
        self.back.visible = shown
        self.desk.cover("parts", shown)

    def _show(self) -> None:
        if self.view.value:
            self.desk.scene.marks.clear_cell()
            ticked = {name for name, box in self.boxes.items() if box.value}
            self.desk.scene.parts.show(ticked, self.spread.value)
