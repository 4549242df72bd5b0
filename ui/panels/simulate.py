"""Simulate: the object, where and how far it is pressed; runs the contact and the images."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import Any

import viser

from ui.desk import Desk
from workbench.core.errors import DesignError
from workbench.core.indenter import IndenterKind
from workbench.indenter_choice import choose_indenter

MAX_STL_BYTES = 40 * 2**20
"""Larger files do not pass the browser's connection; the command line takes them."""
SHAPES = tuple(k.value for k in IndenterKind if k is not IndenterKind.MESH)


class SimulatePanel:
    """Widgets of the fourth tab."""

    def __init__(self, desk: Desk) -> None:
        self.desk = desk
        gui, fields = desk.server.gui, desk.fields
        with gui.add_folder("Object"):
            now = desk.session.case.indenter.kind.value
            options = (*SHAPES, "mesh") if now == "mesh" else SHAPES
            self.kind = gui.add_dropdown("Object shape", options, initial_value=now)
            self.kind.on_update(desk.guarded(self._choose))
            hint = "Diameter, else the largest width"
            self.size = gui.add_slider(
                "Size mm", 1.0, 30.0, 0.5, desk.session.case.indenter.size_mm, hint=hint
            )
            self.size.on_update(desk.guarded(self._choose))
            self.stl = gui.add_upload_button("Load STL", mime_type=".stl")
            self.stl.on_upload(desk.guarded(self._load_stl))
        with gui.add_folder("Press"):
            hint = "Near the skin; or click on the skin to aim"
            fields.point("Target mm", "case.press.target_mm", step=0.5, hint=hint)
            hint = "From first touch, along the inward normal"
            fields.slider("Depth mm", "case.press.depth_mm", span=(0.0, 3.0, 0.05), hint=hint)
            hint = "Of the approach; shear and twist take as many again"
            fields.slider("Frames", "case.press.frames", span=(1, 40, 1), whole=True, hint=hint)
            fields.slider("Twist deg", "case.press.twist_deg", span=(-45.0, 45.0, 1.0))
            hint = "U is +Z along the skin, V is across"
            self.shear = gui.add_vector2(
                "Shear U V mm", desk.session.case.press.shear_mm, step=0.1, hint=hint
            )
            self.shear.on_update(desk.guarded(self._shear))
        with gui.add_folder("Solver", expand_by_default=False):
            fields.slider("Grid mm", "case.settings.grid_mm", span=(0.25, 1.5, 0.05))
            hint = "Radius of the simulated region; 0: chosen from contact and wall"
            fields.number("Region mm", "case.settings.active_radius_mm", step=1.0, hint=hint)
        button = gui.add_button("Run press", icon=viser.Icon.PLAYER_PLAY, hint="Contact, image (R)")
        button.on_click(desk.guarded(self._run))
        desk.reports.beside("press")
        command = gui.add_command("Run press", hotkey="R")
        command.on_trigger(desk.guarded(self._run))
        self.numbers = gui.add_markdown("")
        self.found = ""

    def _run(self, event: Any) -> None:
        self.desk.run("press", ("press", "shoot"))

    def _choose(self, event: Any) -> None:
        if event.client is None:
            return
        indenter = self.desk.session.case.indenter
        if self.kind.value != "mesh":
            indenter = choose_indenter(self.kind.value, size_mm=float(self.size.value))
            self.desk.session.replace_indenter(indenter)
            self._follow()

    def _load_stl(self, event: Any) -> None:
        file = self.stl.value
        if len(file.content) > MAX_STL_BYTES:
            raise DesignError(
                f"{file.name} has {len(file.content) / 2**20:.0f} MB, the browser takes "
                f"{MAX_STL_BYTES / 2**20:.0f} MB",
                hint="reduce the mesh, or use workbench run --indenter FILE.stl",
                at="indenter",
            )
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "upload.stl"
            path.write_bytes(file.content)
            indenter = choose_indenter(str(path))
        self.desk.session.replace_indenter(indenter)
        self.kind.options = (*SHAPES, "mesh")
        self._follow()

    def _follow(self) -> None:
        case = self.desk.session.case
        self.desk.reports.settle()
        self.refresh()
        self.desk.scene.show_indenter(case.indenter, case.press)
        self.desk.changed()

    def _shear(self, event: Any) -> None:
        if event.client is not None:
            u_mm, v_mm = self.shear.value
            self.desk.edit("case.press.shear_mm", (float(u_mm), float(v_mm)))

    def refresh(self) -> None:
        """Show the state as it stands."""
        case = self.desk.session.case
        if self.kind.value != case.indenter.kind.value:
            if case.indenter.kind is IndenterKind.MESH:
                self.kind.options = (*SHAPES, "mesh")
            self.kind.value = case.indenter.kind.value
        size_mm = min(max(case.indenter.size_mm, 1.0), 30.0)
        if self.size.value != size_mm:
            self.size.value = size_mm
        if tuple(self.shear.value) != case.press.shear_mm:
            self.shear.value = case.press.shear_mm
        stale = self.found and not self.desk.current("press")
        text = f"**stale** · {self.found}" if stale else self.found
        if self.numbers.content != text:
            self.numbers.content = text

    def show(self, stage: str, result: Any) -> None:
        """Show the force of the last frame, with its residual and penetration beside it."""
        if stage == "sensor":
            self.found = self.numbers.content = ""
        if stage == "press":
            self.found = (
                f"**{result.normal_N[-1]:.3f} N** along the normal · residual "
                f"{result.residual.max():.1e} · penetration "
                f"{1e3 * result.penetration_mm.max():.0f} µm · {result.substeps} substeps"
            )
            self.numbers.content = self.found
