"""The View tab: where to look from, the section, what is on show, measuring, the scene as a file.

It stands in the dock on the right: afloat it would hide the body that is cut.
"""

from __future__ import annotations

from functools import partial
from typing import Any

import viser

from ui.desk.desk import Desk
from ui.panels.page import Page
from ui.panels.view.hand_out import save_scene
from ui.patches.view_cube import FACES, ViewCube
from ui.scene.look import OPACITY, Look, Seen
from ui.scene.measure import Measure
from ui.scene.reach import Reach
from ui.scene.views import AWAY, USUAL, Side
from workbench.view.section_cut import Axis, Plane

STEP_MM = 0.1
CLOSE_MM = 9.0
"""Half an edge of the box around a contact that is looked at."""


class ViewPanel:
    """Widgets of the tab; it follows bodies, so that a cut has their range."""

    def __init__(self, desk: Desk, dock: Any) -> None:
        self.desk = desk
        self.look = Look(desk.scene)
        self.measure = Measure(desk.scene, desk.scene.on_click)
        desk.click_handlers.append(self.measure.takes)
        gui = desk.server.gui
        with dock.add_tab("View"):
            self._sides()
            self._section()
            self._measuring()
            self._seen()
            hint = "One file that opens without the workbench, with the frames to play"
            save = gui.add_button("Save scene (HTML)", icon=viser.Icon.DOWNLOAD, hint=hint)
            save.on_click(desk.guarded(lambda event: save_scene(desk, event.client)))

    def _sides(self) -> None:
        gui, guarded = self.desk.server.gui, self.desk.guarded
        hint = "Keys 1 to 8; in this tab only. Contact looks at the press from beside its object"
        self.sides = gui.add_button_group("Look from", [side.value for side in USUAL], hint=hint)
        self.sides.on_click(guarded(lambda event: self._turn(Side(self.sides.value), event)))
        for number, side in enumerate(Side, start=1):
            command = gui.add_command(f"Look from: {side.value}", hotkey=str(number))  # pyright: ignore[reportArgumentType]
            command.on_trigger(guarded(partial(self._turn, side)))
        keys = {side.value: str(number) for number, side in enumerate(Side, start=1)}
        self.cube = ViewCube(self.desk.server, {word: keys[word] for word in FACES})
        self.desk.on_turn.append(self.cube.turn)

        hint = "Look at all that is on show, from where you look now (F)"
        fit = gui.add_button("Fit view", icon=viser.Icon.FOCUS_CENTERED, hint=hint)
        fit.on_click(guarded(lambda event: self.desk.scene.fit_view()))
        command = gui.add_command("Fit view", hotkey="F")
        command.on_trigger(guarded(lambda event: self.desk.scene.fit_view()))

    def _turn(self, side: Side, event: Any) -> None:
        scene, press = self.desk.scene, self.desk.session.case.press
        place = scene.body.place_near(press.target_mm) if side is Side.CONTACT else None
        if place is None:
            scene.views.look_from(side, *scene.bounds_mm, client=event.client)
        else:
            toward = scene.body.side_of(press.target_mm, AWAY)
            box = place.point_mm - CLOSE_MM, place.point_mm + CLOSE_MM
            scene.views.look_from(side, *box, client=event.client, toward=toward)
        self._face(event.client)

    def _section(self) -> None:
        gui, guarded = self.desk.server.gui, self.desk.guarded
        hint = "Cut skin, support and foot, or the parts on show, by a plane (C)"
        self.on = gui.add_checkbox("Section", False, hint=hint)
        self.axis = gui.add_dropdown(
            "Section axis",
            tuple(axis.value for axis in Axis),
            initial_value=Axis.Y.value,
            hint="The plane is square to this axis of the sensor",
        )
        self.place = gui.add_slider(
            "Section at mm", -20.0, 20.0, STEP_MM, 0.0, hint="Along the axis; it stays at edits"
        )
        hint = "Keep the other side"
        self.flip = gui.add_checkbox("Flip section", False, hint=hint)
        self.reach = Reach(self.place)
        self.desk.scene.on_extent = self._fit_range
        self.on.on_update(guarded(self._switch))
        self.axis.on_update(guarded(self._other_axis))
        self.place.on_update(guarded(lambda event: self._cut()))
        self.flip.on_update(guarded(lambda event: self._cut()))
        command = gui.add_command("Section on or off", hotkey="C")
        command.on_trigger(guarded(self._toggle))

    def _toggle(self, event: Any) -> None:
        self.on.value = not self.on.value
        self._switch(event)

    def _switch(self, event: Any) -> None:
        """Cut, or make whole again; the cut faces the tab that asked for it."""
        self._face(event.client)
        self._cut()

    def _face(self, client: Any) -> None:
        """Take away the half that hides the cut from a tab's eye."""
        if client is not None:
            along_mm = float(client.camera.position[Axis(self.axis.value).number])
            self.flip.value = along_mm < float(self.place.value)

    def _other_axis(self, event: Any) -> None:
        low, high = self._range()
        self._fit_range()
        self.place.value = round((low + high) / 2, 1)
        self._face(event.client)
        self._cut()

    def _range(self) -> tuple[float, float]:
        """Extent of what is on show along the axis [mm]."""
        number = Axis(self.axis.value).number
        low, high = self.desk.scene.bounds_mm
        return float(low[number]), float(high[number])

    def _fit_range(self) -> None:
        """Give the slider the range of what is on show; its value stays where it can."""
        low, high = self._range()
        scene = self.desk.scene
        parts = scene.hidden and bool(scene.parts.shown)
        self.reach.fit(low, high, axis=Axis(self.axis.value), parts=parts)

    def _cut(self) -> None:
        plane = None
        if self.on.value:
            plane = Plane(
                axis=Axis(self.axis.value),
                position_mm=float(self.place.value),
                flip=bool(self.flip.value),
            )
        self.desk.scene.section.cut(plane)

    def _measuring(self) -> None:
        gui, guarded = self.desk.server.gui, self.desk.guarded
        hint = "Two clicks on skin, caps or parts (M); Escape ends it"
        button = gui.add_button("Measure distance", icon=viser.Icon.RULER_MEASURE, hint=hint)
        button.on_click(guarded(lambda event: self.measure.switch(not self.measure.on)))
        self.said = gui.add_markdown("")
        self.measure.on_message = self._say
        command = gui.add_command("Measure distance", hotkey="M")
        command.on_trigger(guarded(lambda event: self.measure.switch(not self.measure.on)))
        command = gui.add_command("End measuring", hotkey="escape")
        command.on_trigger(guarded(lambda event: self._end_measuring()))

    def _end_measuring(self) -> None:
        if self.measure.on:
            self.measure.switch(False)

    def _say(self, text: str) -> None:
        self.said.content = text

    def _seen(self) -> None:
        gui, guarded = self.desk.server.gui, self.desk.guarded
        with gui.add_folder("Show and fade", expand_by_default=False):
            for what in Seen:
                box = gui.add_checkbox(f"Show {what.value}", True, hint="Also when rebuilt")
                box.on_update(guarded(partial(self._show, what, box)))
                if what in OPACITY:
                    hint = "0 is invisible, 100 is opaque; a pressed, coloured skin is opaque"
                    if what is not Seen.SKIN:
                        hint = "0 is invisible, 100 is opaque"
                    if what is Seen.OBJECT:
                        hint += "; until it is moved, only while the object presses"
                    slider = gui.add_slider(
                        f"{what.value} opacity %", 0, 100, 1, round(100 * OPACITY[what]), hint=hint
                    )
                    slider.on_update(guarded(partial(self._fade, what, slider)))

    def _show(self, what: Seen, box: Any, event: Any) -> None:
        self.look.show(what, bool(box.value))

    def _fade(self, what: Seen, slider: Any, event: Any) -> None:
        self.look.fade(what, float(slider.value) / 100.0)

    def refresh(self) -> None:
        """Nothing here belongs to the state."""

    def show(self, stage: str, result: Any) -> None:
        """Follow bodies and their meshes; what was measured on another body goes."""
        if stage == "mesh":
            self.desk.scene.section.take_mesh(result)
        if stage in ("build", "covered", "parts"):
            self._fit_range()
            if self.on.value:
                self._cut()
        if stage in ("build", "covered") and self.measure.on:
            self.measure.switch(True)


PAGE = Page(place=2, label="View")
