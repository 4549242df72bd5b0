"""Shape: the family's parameters, the layers, the material, history and files."""

from __future__ import annotations

from typing import Any

import viser

from ui.desk import Desk
from workbench.core.errors import DesignError
from workbench.forms import choices, load_design, sliders
from workbench.project import MAX_TOML_BYTES, design_to_toml
from workbench.state import case_table, read_state


class ShapePanel:
    """Widgets of the first tab."""

    def __init__(self, desk: Desk) -> None:
        self.desk = desk
        gui = desk.server.gui
        self.start = gui.add_dropdown(
            "Start from", choices(), hint="Replaces the whole design; Undo brings yours back"
        )
        self.start.on_update(desk.guarded(self._start_from))
        self.name = gui.add_text("Name", desk.session.design.name)
        self.name.on_update(desk.guarded(self._rename))
        self.folder = gui.add_folder("Body")
        self.family = ""
        self._fill()
        with gui.add_folder("Layers"):
            span = (0.8, 6.0, 0.1)
            desk.fields.slider(
                "Elastomer mm", "design.layers.elastomer_mm", span=span, hint="Soft sensing wall"
            )
            span = (0.4, 5.0, 0.1)
            desk.fields.slider(
                "Support mm", "design.layers.support_mm", span=span, hint="Rigid clear shell"
            )
        with gui.add_folder("Material", expand_by_default=False):
            self._material()
        with gui.add_folder("Mesh", expand_by_default=False):
            desk.fields.slider("Hexahedra mm", "design.meshing.hex_mm", span=(0.2, 1.5, 0.05))
        history = gui.add_button_group("History", ("Undo", "Redo"))
        history.on_click(desk.guarded(lambda event: self._history(history.value)))
        gui.add_button("Download design", icon=viser.Icon.DOWNLOAD).on_click(
            desk.guarded(self._download)
        )
        self.upload = gui.add_upload_button("Load design (TOML)", mime_type=".toml")
        self.upload.on_upload(desk.guarded(self._load))
        undo = gui.add_command("Undo", hotkey="Z", modifier="cmd/ctrl")
        undo.on_trigger(desk.guarded(lambda event: self._history("Undo")))
        redo = gui.add_command("Redo", hotkey="Z", modifier="cmd/ctrl+shift")
        redo.on_trigger(desk.guarded(lambda event: self._history("Redo")))

    def _material(self) -> None:
        fields = self.desk.fields
        hint = "0.145 MPa is the silicone of the GelTip"
        fields.number("Young MPa", "design.material.young_MPa", step=0.005, hint=hint)
        fields.number("Poisson", "design.material.poisson", step=0.01, hint="Below 0.495")
        fields.number("Friction", "design.material.friction", step=0.05, hint="Coulomb")

    def _fill(self) -> None:
        """Sliders of the family; made anew when the family changes."""
        desk = self.desk
        family = desk.session.design.family
        if family == self.family:
            return
        self.family = family
        desk.fields.forget("design.shape.")
        with self.folder:
            for slider in sliders(family):
                source = f" (source: {slider.source})" if slider.source else ""
                desk.fields.slider(
                    f"{slider.label} {slider.unit}".strip(),
                    f"design.shape.{slider.name}",
                    span=(slider.minimum, slider.maximum, slider.step),
                    hint=slider.hint + source,
                )

    def _start_from(self, event: Any) -> None:
        if event.client is not None:
            self.desk.session.replace_design(load_design(self.start.value))
            self.desk.replaced()

    def _rename(self, event: Any) -> None:
        if event.client is not None and self.name.value.strip():
            self.desk.edit("design.name", self.name.value.strip()[:80])

    def _history(self, direction: str) -> None:
        session = self.desk.session
        moved = session.undo() if direction == "Undo" else session.redo()
        if moved:
            self.desk.log(direction.lower())
            self.desk.replaced()

    def _download(self, event: Any) -> None:
        session = self.desk.session
        design = session.design
        press_case = case_table(session.case, session.project)
        content = design_to_toml(design, press_case=press_case).encode()
        event.client.send_file_download(f"{design.name}.toml", content, save_immediately=True)

    def _load(self, event: Any) -> None:
        file = self.upload.value
        if len(file.content) > MAX_TOML_BYTES:
            raise DesignError(
                f"{file.name} has {len(file.content)} bytes, a design at most {MAX_TOML_BYTES}",
                hint="choose a TOML file saved by the workbench",
                at="design",
            )
        try:
            text = file.content.decode("utf-8")
        except UnicodeDecodeError as error:
            raise DesignError(
                f"{file.name} is not UTF-8 text", hint="choose a TOML file", at="design"
            ) from error
        session = self.desk.session
        session.replace_state(read_state(text, session.project, source=file.name))
        self.desk.replaced()

    def refresh(self) -> None:
        """Show the state as it stands."""
        self._fill()
        if self.name.value != self.desk.session.design.name:
            self.name.value = self.desk.session.design.name

    def show(self, stage: str, result: Any) -> None:
        """Nothing here follows results."""
