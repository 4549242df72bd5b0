"""Files for the workshop: one part in one format, or everything with the build sheet."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import viser

from ui.desk.desk import Desk
from workbench.core.base.errors import WorkbenchError
from workbench.core.result.fabrication import FabricationPart
from workbench.core.result.results import Bundle
from workbench.project.design_bundle import zipped
from workbench.system.names import NONE
from workbench.view.part_words import part_label

FORMATS = {
    "stl": "Triangles in mm, for slicers",
    "step": "Exact faces, for CAD",
    "3mf": "Triangles with their unit, for slicers",
}
"""Endings of files, and what each is for."""


class Downloads:
    """Widgets below the recipe; there once the files are written."""

    def __init__(self, desk: Desk) -> None:
        self.desk = desk
        self._names: dict[str, str] = {}
        """Of files, by what the parts are called on the page."""
        self._waiting: tuple[Any, str] | None = None
        """Tab that waits for all files, and the key of what it asked for: of another design it gets
        none."""
        self.folder = desk.server.gui.add_folder("Files", visible=False)
        with self.folder:
            self._fill()

    def _fill(self) -> None:
        gui, desk = self.desk.server.gui, self.desk
        self.part = gui.add_dropdown("Part", (NONE,), hint="Whose file is downloaded")
        for name, hint in FORMATS.items():
            label = f"Download part {name.upper()}"
            button = gui.add_button(label, icon=viser.Icon.DOWNLOAD, hint=hint)
            button.on_click(desk.guarded(partial(self._one, name)))

    def offer(self, parts: tuple[FabricationPart, ...]) -> None:
        """Offer the files of these parts, and send them all to who waits for them."""
        self.folder.visible = bool(parts)
        self._names = {part_label(part.name): part.name for part in parts}
        self.part.options = tuple(self._names) or (NONE,)
        waiting, self._waiting = self._waiting, None
        if waiting is not None and waiting[1] == self._key():
            if parts:
                self._send(waiting[0])
            else:
                self._waiting = waiting

    def _key(self) -> str:
        """Of the files of the design as it stands."""
        return self.desk.session.calls()["package"].key

    def _bundle(self) -> Bundle:
        bundle = self.desk.session.result("package")
        if bundle is None:
            raise WorkbenchError(
                "the parts of this design have not been made", hint="press Make parts first"
            )
        return bundle

    def _one(self, ending: str, event: Any) -> None:
        wanted = f"/{self._names.get(self.part.value, self.part.value)}.{ending}"
        files = self._bundle().files
        found = next((name for name in files if name.endswith(wanted)), None)
        if found is None:
            raise WorkbenchError(
                f"there is no {ending.upper()} file of {self.part.value}",
                hint="choose another format; the build sheet says why",
            )
        content = files[found].tobytes()
        event.client.send_file_download(wanted[1:], content, save_immediately=True)

    def all(self, event: Any, make: Callable[[Any], None]) -> None:
        """Send everything, made first where it is not there yet."""
        if self.desk.session.fresh()["package"]:
            self._send(event.client)
            return
        self._waiting = event.client, self._key()
        make(event)

    def _send(self, client: Any) -> None:
        files = {name: data.tobytes() for name, data in self._bundle().files.items()}
        name = f"{self.desk.session.design.name}-parts.zip"
        client.send_file_download(name, zipped(files), save_immediately=True)
