"""The design as something to keep: name, save, copy, open, delete, download and load.

What is opened replaces the whole design and press; Undo brings yours back. Drawing the small
thumbnail of a kept design is left to the worker, in a thread that only waits for it.
"""

from __future__ import annotations

import dataclasses
import threading
from collections.abc import Sequence
from typing import Any

import viser

from ui.desk.desk import Desk
from ui.page.gallery import Card, shortened
from ui.panels.shape.question import ask
from workbench.core.base.errors import WorkbenchError
from workbench.core.base.monitor import silent
from workbench.edit.forms import choices, load_design, purpose
from workbench.edit.shipped_thumbnails import shipped_thumbnail
from workbench.planning.plan import plan
from workbench.project.design_bundle import bundle, unbundle
from workbench.project.saved_designs import (
    SavedDesign,
    SavedShelf,
    delete_design,
    file_stamp,
    open_design,
    restore_design,
    save_named,
    saved_names,
)
from workbench.project.state import State
from workbench.report.thumbnails import thumbnail_calls
from workbench.system.names import NONE, numbered

SAVE, COPY = "Save design", "Duplicate"
YOURS = "Your designs"
MARK = " (yours)"
"""Ends the card of a kept design."""
LONGEST = 60
"""Letters of the line below a card."""


class DesignFiles:
    """Widgets about the design as a whole."""

    def __init__(self, desk: Desk) -> None:
        self.desk = desk
        self.project = desk.session.project
        self.shelf = SavedShelf(self.project)
        self.known: dict[str, tuple[int, int] | None] = {}
        """Stamps of the files that were opened or saved here, by name: no others are replaced
        without asking."""
        self.read = desk.session.design.name
        """The name of the design when its box was last read or written."""
        self.trashed = ""
        """Name in the trash of what was deleted last."""

    def gallery_button(self) -> None:
        """Make the button that opens the gallery."""
        hint = "Presets, families and your own designs as pictures (G)"
        button = self.desk.server.gui.add_button(
            "Gallery of designs", icon=viser.Icon.LAYOUT_GRID, hint=hint
        )
        button.on_click(self.desk.guarded(self._open_gallery))
        command = self.desk.server.gui.add_command("Gallery of designs", hotkey="G")
        command.on_trigger(self.desk.guarded(self._open_gallery))

    def name_widgets(self) -> None:
        """Make the name and what keeps the design under it."""
        desk, gui = self.desk, self.desk.server.gui
        self.name = gui.add_text(
            "Name",
            desk.session.design.name,
            hint="Of the design; Save design keeps it under this name",
        )
        self.name.on_update(desk.guarded(self._rename))
        hint = "Save keeps it under its name (Ctrl+S); Duplicate goes on with a copy"
        keep = gui.add_button_group("Design", (SAVE, COPY), hint=hint)
        keep.on_click(desk.guarded(lambda event: self._keep(keep.value, event)))
        command = gui.add_command(SAVE, hotkey="S", modifier="cmd/ctrl")
        command.on_trigger(desk.guarded(lambda event: self._keep(SAVE, event)))
        desk.fields.anchor("Name", "design.name")

    def file_widgets(self) -> None:
        """Make the folder of files."""
        desk, gui = self.desk, self.desk.server.gui
        with gui.add_folder("Design files", expand_by_default=False):
            hint = "Of your own; the gallery shows them as pictures"
            self.kept = gui.add_dropdown("Saved design", (NONE,), hint=hint)
            hint = "Delete moves the file to the project's designs/trash, and can be undone"
            acts = gui.add_button_group("With it", ("Open", "Delete"), hint=hint)
            acts.on_click(desk.guarded(lambda event: self._with_kept(acts.value)))
            self.restore = gui.add_button(
                "Bring deleted design back",
                icon=viser.Icon.ARROW_BACK_UP,
                visible=False,
                hint="The design deleted last stands in the list again",
            )
            self.restore.on_click(desk.guarded(self._restore))
            hint = "Readable TOML; a zip where it needs files of its own"
            button = gui.add_button("Download design", icon=viser.Icon.DOWNLOAD, hint=hint)
            button.on_click(desk.guarded(self._download))
            self.upload = gui.add_upload_button(
                "Load design (TOML)",
                mime_type=".toml,.zip",
                hint="A design, or a zip with its files; Undo brings yours back",
            )
            self.upload.on_upload(desk.guarded(self._load))
        self._list()
        # Reading many takes a second, which the first gallery need not wait for.
        threading.Thread(target=self.shelf.entries, name="designs", daemon=True).start()

    def refresh(self) -> None:
        """Show a name that came from elsewhere; one that is being typed stays."""
        name = self.desk.session.design.name
        if name != self.read:
            self.read = self.name.value = name

    def _list(self) -> None:
        names = saved_names(self.project) or (NONE,)
        if tuple(self.kept.options) != names:
            now = self.kept.value
            self.kept.options = names
            self.kept.value = now if now in names else names[0]

    def _rename(self, event: Any) -> None:
        if event.client is not None:
            self._read_name()

    def _read_name(self) -> None:
        """Take the name that stands in its box.

        Handlers run in threads, in no order of their own: Save may come before that of the name.
        """
        typed = self.name.value.strip()[:80]
        if typed and typed != self.desk.session.design.name:
            self.desk.edit("design.name", typed)
        self.read = self.desk.session.design.name

    def _keep(self, what: str, event: Any) -> None:
        desk = self.desk
        desk.fields.read_typed(now=True)
        self._read_name()
        name = desk.session.design.name
        stamp = file_stamp(self.project, name)
        if what == COPY:
            self._save_copy()
        elif stamp is None or self.known.get(name) == stamp:
            self._save()
        else:
            words = f"The file {name} was neither opened nor saved here. Replace keeps the file "
            words += "as a version in designs/previous; Keep both saves yours under another name."
            answers = {"Replace": self._save, "Keep both": self._save_copy}
            ask(desk, event.client, "There is another design of this name", words, answers)

    def _save_copy(self) -> None:
        session = self.desk.session
        name = numbered(session.design.name, saved_names(self.project))
        copy = dataclasses.replace(session.design, name=name)
        session.replace_state(dataclasses.replace(session.state, design=copy))
        self.desk.replaced()
        self._save()

    def _save(self) -> None:
        desk = self.desk
        state = desk.session.state
        save_named(self.project, state)
        self._know(state.design.name)
        self._list()
        desk.log(f"design {state.design.name} saved")
        desk.reports.notify("Saved", f"{state.design.name}: design and press", color="green")
        self._draw(state)

    def _draw(self, state: State) -> None:
        """Have the thumbnail of a design drawn, if its body is stored."""
        store, runner = self.project.store, self.desk.conductor.runner

        def wait(call: Any) -> None:
            try:
                runner.run(call, silent)
            except WorkbenchError as error:
                # A design without a thumbnail is still a design.
                self.desk.log(f"no thumbnail of {state.design.name}: {error.message}")

        keys = {"build": plan(state.design, state.case)["build"].key}
        for call in thumbnail_calls(store, keys):
            threading.Thread(target=wait, args=(call,), name="thumbnail", daemon=True).start()

    def _with_kept(self, what: str) -> None:
        name = self.kept.value
        if name == NONE:
            return
        if what == "Open":
            self._open_kept(name)
            return
        self.trashed = delete_design(self.project, name)
        self.restore.visible = True
        self._list()
        self.desk.reports.notify("Deleted", f"{name}: kept as trash/{self.trashed}.toml")

    def _restore(self, event: Any) -> None:
        self.restore.visible = False
        name = restore_design(self.project, self.trashed)
        self._list()
        self.kept.value = name

    def _know(self, name: str) -> None:
        """The file of this name is the design on show: Save may replace it."""
        self.known[name] = file_stamp(self.project, name)

    def forget(self) -> None:
        """The design on show comes from elsewhere: a kept one of its name is another."""
        self.known.pop(self.desk.session.design.name, None)

    def _open_kept(self, name: str) -> None:
        self._open(open_design(self.project, name))
        self._know(name)

    def _open(self, state: State) -> None:
        self.desk.session.replace_state(state)
        self.desk.replaced()

    def _start(self, name: str) -> None:
        self.desk.session.replace_design(load_design(name))
        self.forget()
        self.desk.replaced()

    def _download(self, event: Any) -> None:
        name, content = bundle(self.desk.session.state, self.project)
        event.client.send_file_download(name, content, save_immediately=True)

    def _load(self, event: Any) -> None:
        file = self.upload.value
        self._open(unbundle(file.name, file.content, self.project))
        self.forget()

    def _open_gallery(self, event: Any) -> None:
        desk, cards = self.desk, (*shipped_cards(), *self.own_cards(self.shelf.entries()))
        desk.galleries.show(event.client, "Start from", cards, desk.guarded(self.choose))

    def choose(self, name: str) -> None:
        """Open what a card stands for."""
        kept = name.removesuffix(MARK)
        if name.endswith(MARK) and kept in saved_names(self.project):
            self._open_kept(kept)
        else:
            self._start(name)

    def own_cards(self, entries: Sequence[SavedDesign], group: str = YOURS) -> list[Card]:
        """Cards of kept designs."""
        return [
            Card(
                name=f"{found.name}{MARK}",
                words=_short(found.reason or found.family),
                png=self._thumbnail(found),
                group=group,
            )
            for found in entries
        ]

    def _thumbnail(self, found: SavedDesign) -> bytes | None:
        """What was drawn of a kept design, else its family's thumbnail."""
        if found.reason:
            return None
        store = self.project.store
        for call in thumbnail_calls(store, {"build": found.build}):
            if store.has(call.stage, call.key):
                return bytes(store.load(call.stage, call.key).png)
        return shipped_thumbnail(f"start-{found.family}")


def shipped_cards(group: str = "") -> list[Card]:
    """Cards of all that a design can start from."""
    return [
        Card(
            name=name,
            words=_short(purpose(name)),
            png=shipped_thumbnail(f"start-{name}"),
            group=group,
        )
        for name in choices()
    ]


def _short(words: str) -> str:
    """The first sentence, cut at a word to what a card holds."""
    first = words.split(": ", 1)[-1].split(". ", 1)[0].rstrip(".")
    return shortened(first, LONGEST)
