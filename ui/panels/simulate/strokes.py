"""The motion of the contact studio: strokes one after the other, or a trajectory from a file."""

from __future__ import annotations

from typing import Any

import viser

from ui.desk.desk import Desk
from ui.page.choice_hint import told_with_name
from workbench.core.press.motion import Mover, Stroke, StrokeKind
from workbench.edit.path_template import template_csv
from workbench.edit.strokes import EXAMPLES, read_stroke
from workbench.edit.trajectories import uploaded_trajectory
from workbench.view.choice_words import named, stroke_words, words

UP, REMOVE = "Up", "Remove"
KINDS = named(StrokeKind)
"""Strokes by what designers read."""
AMOUNTS = {
    StrokeKind.PRESS: "mm deeper",
    StrokeKind.SLIDE: "mm along U,V",
    StrokeKind.TWIST: "degree",
    StrokeKind.ROLL: "degree, axis in degree from U",
    StrokeKind.LIFT: "mm outward",
    StrokeKind.RELEASE: "mm clear of the skin",
    StrokeKind.HOLD: "nothing but frames",
    StrokeKind.MOVE: "mm along U,V,n",
}


class MotionFolder:
    """Widgets of the folder."""

    def __init__(self, desk: Desk) -> None:
        self.desk = desk
        gui, guarded = desk.server.gui, desk.guarded
        self.rows: list[Any] = []
        self.listed: tuple[Stroke, ...] = ()
        with gui.add_folder("Motion after the approach", expand_by_default=False):
            self.summary = gui.add_markdown("")
            self.list = gui.add_folder("Strokes")
            desk.fields.anchor("Strokes", "case.press.strokes")
            hint = "What the object does after the approach"
            self.kind = gui.add_dropdown(
                "Stroke", tuple(KINDS), initial_value=words(StrokeKind.SLIDE), hint=hint
            )
            told_with_name(self.kind, hint, KINDS)
            self.kind.on_update(guarded(lambda event: self._suggest()))
            self.amount = gui.add_text("Amount", "", hint="In the unit that stands below")
            self.unit = gui.add_markdown("")
            self.frames = gui.add_slider(
                "Stroke frames", 1, 60, 1, 10, hint="Frames that this move takes"
            )
            button = gui.add_button(
                "Add stroke", icon=viser.Icon.PLUS, hint="After those that are listed"
            )
            button.on_click(guarded(self._add))
            with gui.add_folder("Trajectory", expand_by_default=False):
                desk.fields.anchor("Trajectory", "case.press.trajectory")
                hint = "CSV of times and poses; in place of depth, shear, twist and strokes"
                self.file = gui.add_upload_button("Load trajectory", mime_type=".csv,text/csv",
                                                  icon=viser.Icon.UPLOAD, hint=hint)  # fmt: skip
                self.file.on_upload(guarded(self._load))
                hint = "The poses of this press, or of a straight one, as a file to edit"
                button = gui.add_button("Trajectory template", icon=viser.Icon.DOWNLOAD, hint=hint)
                button.on_click(guarded(self._template))
            hint = "Which of the two moves in the room; contact depends on both alike"
            desk.fields.choice("Mover", "case.press.mover", list(Mover), hint=hint)
            hint = "Strokes, trajectory and drives go; the approach stays"
            button = gui.add_button("Clear motion", icon=viser.Icon.TRASH, hint=hint)
            button.on_click(guarded(self._clear))
        self._suggest()
        self.refresh()

    def _suggest(self) -> None:
        kind = KINDS[self.kind.value]
        parts = EXAMPLES[kind].split(":")
        self.amount.value = parts[1] if len(parts) > 1 and kind is not StrokeKind.HOLD else ""
        self.unit.content = f"<small>{AMOUNTS[kind]}</small>"

    def _add(self, event: Any) -> None:
        frames = int(self.frames.value)
        kind, amount = KINDS[self.kind.value], self.amount.value.strip()
        holds = kind is StrokeKind.HOLD
        typed = f"{kind}:{frames}" if holds else f"{kind}:{amount}"
        stroke = read_stroke(typed if amount or holds else kind.value, frames=frames)
        self._put((*self.desk.session.case.press.strokes, stroke))

    def _put(self, strokes: tuple[Stroke, ...]) -> None:
        self.desk.edit("case.press.strokes", strokes)
        self.refresh()

    def _pressed(self, number: int, word: str) -> None:
        strokes = list(self.desk.session.case.press.strokes)
        if word == REMOVE:
            strokes.pop(number)
        elif number:
            strokes[number - 1 : number + 1] = strokes[number], strokes[number - 1]
        self._put(tuple(strokes))

    def _load(self, event: Any) -> None:
        file = self.file.value
        trajectory = uploaded_trajectory(file.name, file.content)
        self._change(trajectory=trajectory, strokes=())
        if trajectory.notice:
            self.desk.log(trajectory.notice)

    def _template(self, event: Any) -> None:
        desk = self.desk
        contact = desk.session.result("press") if desk.current("press") else None
        text = template_csv(desk.session.case.press, contact, desk.scene.object.standing)
        event.client.send_file_download("trajectory.csv", text.encode(), save_immediately=True)

    def _clear(self, event: Any) -> None:
        self._change(trajectory=None, strokes=(), actuations=(), object_pose=None)

    def _change(self, **values: Any) -> None:
        """Change several fields of the press as one step of undo."""
        self.desk.session.change_press(**values)
        self.desk.reports.settle()
        self.desk.changed()
        self.refresh()

    def refresh(self) -> None:
        """List the strokes as they stand, and say what else moves."""
        press = self.desk.session.case.press
        parts = [f"{len(press.actuations)} regions are driven" if press.actuations else ""]
        if press.trajectory is not None:
            count = press.trajectory.frame_count
            parts.append(f"a trajectory of {count} frames replaces depth, shear and twist")
        text = " · ".join(part for part in parts if part)
        if self.summary.content != text:
            self.summary.content = text
        if press.strokes != self.listed:
            self._list(press.strokes)

    def _list(self, strokes: tuple[Stroke, ...]) -> None:
        self.listed = strokes
        for row in self.rows:
            row.remove()
        self.rows.clear()
        with self.list:
            for number, stroke in enumerate(strokes):
                label = f"{number + 1} {stroke_words(stroke)} ×{stroke.frames}"
                row = self.desk.server.gui.add_button_group(label, (UP, REMOVE))
                row.on_click(self.desk.guarded(self._handler(number)))
                self.rows.append(row)
            if not strokes:
                self.rows.append(self.desk.server.gui.add_markdown("<small>none</small>"))

    def _handler(self, number: int) -> Any:
        return lambda event: self._pressed(number, event.target.value)
