"""Undo and redo, and the design as a file."""

from __future__ import annotations

from typing import Any

import viser

from ui.desk import Desk
from ui.panels.downloads import zipped
from workbench.core.errors import DesignError
from workbench.project import MAX_TOML_BYTES, design_files, design_to_toml
from workbench.state import case_table, read_state


class History:
    """Widgets below the parameters of a shape."""

    def __init__(self, desk: Desk) -> None:
        self.desk = desk
        gui = desk.server.gui
        steps = gui.add_button_group("History", ("Undo", "Redo"))
        steps.on_click(desk.guarded(lambda event: self._step(steps.value)))
        gui.add_button("Download design", icon=viser.Icon.DOWNLOAD).on_click(
            desk.guarded(self._download)
        )
        self.upload = gui.add_upload_button("Load design (TOML)", mime_type=".toml")
        self.upload.on_upload(desk.guarded(self._load))
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

    def _download(self, event: Any) -> None:
        session = self.desk.session
        design = session.design
        session.project.keep_files(design)
        press_case = case_table(session.case, session.project)
        content = design_to_toml(design, press_case=press_case).encode()
        name = f"{design.name}.toml"
        files = design_files(design)
        if files:
            # The files of a body and of pictures travel with the design that names them.
            content = zipped({name: content, **files})
            name = f"{design.name}.zip"
        event.client.send_file_download(name, content, save_immediately=True)

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
