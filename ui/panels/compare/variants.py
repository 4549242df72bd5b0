"""The folder of variants: keep the design as it stands; find, load, rename, copy and delete."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from typing import Any

import viser

from ui.desk.desk import Desk
from ui.desk.thumbnails import ThumbnailQueue
from ui.page.offer import offer
from ui.page.plain import plain
from ui.panels.compare.variant_cards import cards_html
from workbench.core.base.errors import Cancelled, DesignError
from workbench.system.names import NONE
from workbench.variants.variant_files import (
    Entry,
    Shelf,
    delete_variant,
    duplicate_variant,
    list_variants,
    next_name,
    rename_variant,
    restore_variant,
)
from workbench.variants.variants import load_variant, read_tags, save_variant, write_variant

ALL = "all variants"


class VariantsFolder:
    """Widgets of the folder; `entries` are the variants on show."""

    def __init__(self, desk: Desk, on_change: Callable[[], None]) -> None:
        self.desk = desk
        self.project = desk.session.project
        self.on_change = on_change
        self.shelf = Shelf(self.project)
        self.entries: list[Entry] = []
        self.on_save: Callable[[str], None] = lambda name: None
        """Set by the panel: told the name of what was saved."""
        self.trashed = ""
        """Name in the trash of what was deleted last."""
        gui = desk.server.gui
        self.thumbnails = ThumbnailQueue(self.project, desk.conductor.runner, desk.reports)
        self.thumbnails.on_drawn = lambda: desk.guarded(lambda event: self.list())(None)
        with gui.add_folder("Variants"):
            self._form()
            hint = "Only variants with this tag; the score card follows"
            self.tag = gui.add_dropdown("With tag", (ALL,), hint=hint)
            self.tag.on_update(desk.guarded(lambda event: self.list()))
            self.cards = gui.add_html("")
            self._actions()

    def _form(self) -> None:
        gui, desk = self.desk.server.gui, self.desk
        name = next_name(list_variants(self.project))
        self.name = gui.add_text("Variant name", name, hint="Also the name of its file")
        with gui.add_folder("Tags and note", expand_by_default=False):
            self.tags = gui.add_text("Tags", "", hint="Words to find it by, with commas between")
            self.note = gui.add_text("Note", "", multiline=True, hint="Why you keep it")
        hint = "Keeps design, press, images and all figures that are there"
        save = gui.add_button("Save variant", icon=viser.Icon.DEVICE_FLOPPY, hint=hint)
        save.on_click(desk.guarded(self._save))

    def _actions(self) -> None:
        gui, desk = self.desk.server.gui, self.desk
        hint = "What the buttons below act on"
        self.chosen = gui.add_dropdown("Chosen variant", (NONE,), hint=hint)
        self.chosen.on_update(desk.guarded(self._choose))
        self._buttons(
            ("Load variant", viser.Icon.FOLDER_OPEN, "Undo brings your design back", self._load),
            ("Run what is missing", viser.Icon.PLAYER_PLAY, "Press and maps, again", self._run),
        )
        with gui.add_folder("More on the chosen variant", expand_by_default=False):
            to = "Those above, to the chosen"
            self._buttons(
                ("Rename variant", viser.Icon.PENCIL, "To the name above", self._rename),
                ("Write tags and note", viser.Icon.TAG, to, self._annotate),
                ("Duplicate variant", viser.Icon.COPY, "Under the next name", self._copy),
                ("Delete variant", viser.Icon.TRASH, "Asks first, and can be undone", self._ask),
            )
            self.question = gui.add_folder(None, visible=False)
            with self.question:
                self.asked = gui.add_markdown("")
                gui.add_button(
                    "Yes, delete it",
                    color="red",
                    hint="Moves it to the trash; Undo delete brings it back",
                ).on_click(desk.guarded(self._delete))
                gui.add_button("No, keep it", hint="Nothing is deleted").on_click(
                    desk.guarded(self._keep)
                )
        self.restore = gui.add_button(
            "Undo delete",
            icon=viser.Icon.ARROW_BACK_UP,
            visible=False,
            hint="Brings the variant deleted last back",
        )
        self.restore.on_click(desk.guarded(self._restore))

    def _buttons(self, *buttons: tuple[str, Any, str, Callable[[Any], None]]) -> None:
        """Buttons with label, icon, hint and handler."""
        for label, icon, hint, handler in buttons:
            button = self.desk.server.gui.add_button(label, icon=icon, hint=hint)
            button.on_click(self.desk.guarded(handler))

    def list(self) -> None:
        """Show the variants as the files stand, and offer them."""
        every = self.shelf.entries()
        tags = sorted({tag for entry in every if entry.variant for tag in entry.variant.tags})
        offer(self.tag, (ALL, *tags))
        self.entries = [entry for entry in every if self._wanted(entry)]
        offer(self.chosen, (NONE, *(entry.name for entry in every)))
        self.cards.content = cards_html(self.entries, self.project.store)
        self.on_change()

    def _wanted(self, entry: Entry) -> bool:
        tag = self.tag.value
        return tag == ALL or (entry.variant is not None and tag in entry.variant.tags)

    def _save(self, event: Any) -> None:
        session, desk = self.desk.session, self.desk
        name = self.name.value.strip()
        if session.result("build") is None:
            raise DesignError(
                "this design has not been built yet", hint="wait for the shape, then save"
            )
        tags = read_tags(self.tags.value)
        save_variant(self.project, name, session.state, tags=tags, note=self.note.value.strip())
        desk.log(f"variant {name} saved")
        pressed = session.result("shoot") is not None
        what = "design, press and figures" if pressed else "the design; it is not pressed yet"
        desk.reports.notify("Saved", f"{name}: {what}", color="green")
        self.thumbnails.draw(name)
        self.list()
        self.chosen.value = name
        self.on_save(name)
        self.name.value = next_name(list_variants(self.project))

    def _name(self) -> str:
        if self.chosen.value == NONE:
            raise DesignError("no variant is chosen", hint="choose one in the list above")
        return self.chosen.value

    def _choose(self, event: Any) -> None:
        self.question.visible = False

    def _load(self, event: Any) -> None:
        name = self._name()
        self.desk.session.replace_state(load_variant(self.project, name).state)
        self.desk.replaced()
        self.desk.reports.notify(
            "Loaded", f"{name} is what you work on now; Undo brings back what stood before"
        )

    def _rename(self, event: Any) -> None:
        new = self.name.value.strip()
        rename_variant(self.project, self._name(), new)
        self._listed(new)
        self.name.value = next_name(list_variants(self.project))

    def _annotate(self, event: Any) -> None:
        variant = load_variant(self.project, self._name())
        tags, note = read_tags(self.tags.value), self.note.value.strip()
        write_variant(self.project, dataclasses.replace(variant, tags=tags, note=note))
        self.list()

    def _copy(self, event: Any) -> None:
        self._listed(duplicate_variant(self.project, self._name()))

    def _listed(self, name: str) -> None:
        """List anew and choose."""
        self.list()
        self.chosen.value = name

    def _run(self, event: Any) -> None:
        """Compute press, image and maps of the chosen variant, then write its figures anew."""
        variant = load_variant(self.project, self._name())

        def then(finished: Any) -> None:
            if isinstance(finished.error, Cancelled):
                return
            if finished.error is not None:
                raise finished.error
            if variant.name not in list_variants(self.project):
                # Renamed or deleted meanwhile: it must not come back.
                return
            state, tags, note = variant.state, variant.tags, variant.note
            save_variant(self.project, variant.name, state, tags=tags, note=note, replace=True)
            self.thumbnails.draw(variant.name)
            self.list()

        self.desk.jobs.submit(
            "variant", variant.state.design, variant.state.case, ("shoot", "maps"), then
        )

    def _ask(self, event: Any) -> None:
        self.asked.content = f"Delete **{plain(self._name())}**?"
        self.question.visible = True

    def _keep(self, event: Any) -> None:
        self.question.visible = False

    def _delete(self, event: Any) -> None:
        self.question.visible = False
        name = self._name()
        self.trashed = delete_variant(self.project, name)
        self.restore.visible = True
        self.desk.log(f"variant {name} moved to the trash")
        self.list()

    def _restore(self, event: Any) -> None:
        self.restore.visible = False
        self._listed(restore_variant(self.project, self.trashed))
