"""Simulate: the contact studio. Object, press, motion and solver; runs the contact, or follows."""

from __future__ import annotations

from typing import Any

import viser

from ui.desk.desk import Desk
from ui.page.callbacks import put
from ui.panels.page import Page
from ui.panels.simulate.objects import ObjectFolder
from ui.panels.simulate.strokes import MotionFolder
from workbench.core.press.press import Extent, Method
from workbench.edit.sequences import find_sequence, sequence, titles
from workbench.project.state import State
from workbench.view.frame_words import number


class SimulatePanel:
    """Widgets of the fourth tab."""

    def __init__(self, desk: Desk) -> None:
        self.desk = desk
        gui = desk.server.gui
        self.objects = ObjectFolder(desk)
        with gui.add_folder("Press"):
            self._press_widgets()
        button = gui.add_button("Run press", icon=viser.Icon.PLAYER_PLAY, hint="Contact, image (R)")
        button.on_click(desk.guarded(self._run))
        hint = "Presses the object, closes the driven parts on it, opens them, lifts it off"
        self.grip = gui.add_button("Grip sequence", icon=viser.Icon.HAND_GRAB, hint=hint)
        self.grip.on_click(desk.guarded(self._run_sequence))
        desk.reports.beside("press")
        command = gui.add_command("Run press", hotkey="R")
        command.on_trigger(desk.guarded(self._run))
        self.numbers = gui.add_markdown("")
        self.motion = MotionFolder(desk)
        with gui.add_folder("Solver", expand_by_default=False):
            self._solver_widgets()
            self.solved = gui.add_markdown("")
        self.found = ""
        self.refresh()

    def _press_widgets(self) -> None:
        desk, fields, gui = self.desk, self.desk.fields, self.desk.server.gui
        hint = "Solve one frame at every change: drag the handle, or move a slider"
        self.live = gui.add_checkbox("Live", False, hint=hint)
        self.live.on_update(desk.guarded(self._switch_live))
        command = gui.add_command("Live press", hotkey="L")
        command.on_trigger(desk.guarded(self._toggle_live))
        hint = "Near the skin; or click on the skin to aim"
        fields.point("Target mm", "case.press.target_mm", step=0.5, hint=hint)
        hint = "From first touch, along the inward normal"
        fields.slider("Depth mm", "case.press.depth_mm", span=(0.0, 3.0, 0.05), hint=hint)
        hint = "Of the approach; shear and twist take as many again"
        fields.slider("Frames", "case.press.frames", span=(1, 40, 1), whole=True, hint=hint)
        fields.slider(
            "Twist deg",
            "case.press.twist_deg",
            span=(-45.0, 45.0, 1.0),
            hint="About the outward normal, at full depth",
        )
        hint = "U is +Z along the skin, V is across"
        self.shear = gui.add_vector2(
            "Shear U V mm", desk.session.case.press.shear_mm, step=0.1, hint=hint
        )
        self.shear.on_update(desk.guarded(self._shear))
        hint = "Coulomb coefficient of the elastomer against the object"
        fields.slider("Friction", "design.material.friction", span=(0.0, 1.5, 0.05), hint=hint)
        # Last, so that nothing moves under the mouse when it comes.
        self.live_text = gui.add_markdown("", visible=False)
        desk.live_said.connect(self._tell_live)

    def _solver_widgets(self) -> None:
        fields = self.desk.fields
        fields.slider(
            "Grid mm",
            "case.settings.grid_mm",
            span=(0.25, 1.5, 0.05),
            hint="Cell of the contact solver; smaller shows smaller dents and takes longer",
        )
        hint = "Only the region around the contact, or the whole membrane"
        fields.choice("Extent", "case.settings.extent", list(Extent), hint=hint)
        hint = "Radius of the simulated region; 0: chosen from contact and wall"
        fields.number("Region mm", "case.settings.active_radius_mm", step=1.0, hint=hint)
        hint = "Share of the force that the chosen region may cost"
        fields.number("Region error", "case.settings.region_error", step=0.001, hint=hint)
        hint = "How contact is computed; the published way is for comparison"
        fields.choice("Method", "case.settings.method", list(Method), hint=hint)

    def _run(self, event: Any) -> None:
        self._end_live()
        self.desk.run("press", ("press", "shoot"))

    def _run_sequence(self, event: Any) -> None:
        """Take the first sequence of the family, run it, and play it."""
        desk = self.desk
        self._end_live()
        design = desk.session.design
        name = next(iter(titles(design)))
        case = sequence(design, find_sequence(design, name))
        desk.session.replace_state(State(design=design, case=case))
        desk.replaced()
        desk.tell("play", None)
        desk.run("press", ("press", "shoot"))

    def _switch_live(self, event: Any) -> None:
        if event.client is not None:
            self.desk.live_switched(bool(self.live.value))

    def _toggle_live(self, event: Any) -> None:
        self.live.value = not self.live.value
        self.desk.live_switched(bool(self.live.value))

    def _end_live(self) -> None:
        """The whole path is wanted, not a preview of its end."""
        if self.desk.live:
            self.live.value = False
            self.desk.live_switched(False)

    def _tell_live(self, text: str) -> None:
        if self.live_text.content != text:
            self.live_text.content = text
        if self.live_text.visible != bool(text):
            self.live_text.visible = bool(text)

    def _shear(self, event: Any) -> None:
        if event.client is not None:
            u_mm, v_mm = self.shear.value
            self.desk.edit("case.press.shear_mm", (float(u_mm), float(v_mm)))

    def refresh(self) -> None:
        """Show the state as it stands."""
        case = self.desk.session.case
        self.objects.refresh()
        self.motion.refresh()
        put(self.shear, case.press.shear_mm)
        named = titles(self.desk.session.design)
        if self.grip.visible != bool(named):
            self.grip.visible = bool(named)
        stale = self.found and not self.desk.current("press")
        text = f"**stale** · {self.found}" if stale else self.found
        if self.numbers.content != text:
            self.numbers.content = text

    def show(self, stage: str, result: Any) -> None:
        """Show the force of the last frame; how well it was solved stands in *Solver*."""
        if stage == "object":
            self.objects.touching.show(result)
        if stage == "sensor":
            self.found = self.numbers.content = self.solved.content = ""
        if stage == "press":
            self.found = f"**{number(result.normal_N[-1], '.3f')} N** along the normal"
            self.numbers.content = self.found
            self.solved.content = (
                f"<small>last press: forces balance to {number(result.residual.max(), '.1e')}, "
                f"object sinks {number(1e3 * result.penetration_mm.max(), '.0f')} µm into the "
                f"skin, {result.substeps} substeps</small>"
            )


PAGE = Page(place=4, label="Simulate", build=SimulatePanel)
