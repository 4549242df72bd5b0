"""The folder of variants: keep the design as it stands; find, load, rename, copy and delete."""

from __future__ import annotations

import base64
import dataclasses
import html
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import viser

from ui.desk import Desk
from ui.plain import plain
from ui.portraits import Portraits
from workbench.core.errors import Cancelled, DesignError
from workbench.variant_files import (
    Entry,
    Shelf,
    delete_variant,
    duplicate_variant,
    list_variants,
    next_name,
    rename_variant,
    restore_variant,
)
from workbench.variants import (
    load_variant,
    read_tags,
    result_keys,
    save_variant,
    write_variant,
)

NONE = "-"
ALL = "all variants"
MOST_PICTURES = 40
"""Thumbnails in the list; each is some 30 KB of the page."""
RED, AMBER = "#e5484d", "#f5a623"


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
        self.portraits = Portraits(self.project, desk.conductor.runner, desk.reports)
        self.portraits.on_drawn = lambda: desk.guarded(lambda event: self.list())(None)
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
        self.cards.content = self._cards()
        self.on_change()

    def _wanted(self, entry: Entry) -> bool:
        tag = self.tag.value
        return tag == ALL or (entry.variant is not None and tag in entry.variant.tags)

    def _cards(self) -> str:
        if not self.entries:
            return "<p style='margin:8px'>No variant yet: press a design, then save it.</p>"
        shown = "".join(
            self._card(entry, pictured=number < MOST_PICTURES)
            for number, entry in enumerate(self.entries)
        )
        # Two or three stand in the list at once: what comes below must not be out of reach.
        box = "margin:4px 8px;font-size:12px;max-height:330px;overflow-y:auto"
        return f"<div style='{box}'>{shown}</div>"

    def _card(self, entry: Entry, *, pictured: bool) -> str:
        """One variant as HTML: all that it holds was typed by somebody, and is escaped."""
        name, variant = html.escape(entry.name), entry.variant
        box = "<div style='border-top:1px solid #8885;padding:6px 0;overflow-wrap:anywhere'>"
        if variant is None:
            reason = html.escape(entry.reason)
            return f"{box}<b>{name}</b> <span style='color:{RED}'>broken: {reason}</span></div>"
        picture = ""
        if pictured and entry.picture is not None:
            picture = picture_html(entry.picture, entry.name)
        pill = "background:#8884;border-radius:8px;padding:0 6px"
        tags = "".join(f" <span style='{pill}'>{html.escape(t)}</span>" for t in variant.tags)
        keys = result_keys(self.project, variant)
        lost = [stage for stage in variant.keys if stage not in keys]
        gone = ""
        if "shoot" not in keys:
            why = "its results were cleared from the store" if lost else "it was never pressed"
            gone = f"<div style='color:{AMBER}'>No image: {why}. Run what is missing.</div>"
        note = f"<div style='white-space:pre-wrap'>{html.escape(variant.note)}</div>"
        when = html.escape(f"{variant.state.design.family} · {variant.saved}".rstrip(" ·"))
        head = f"<b>{name}</b> <span style='opacity:.65'>{when}</span>{tags}"
        return f"{box}{head}{note if variant.note else ''}{gone}{picture}</div>"

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
        self.portraits.draw(name)
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
        self.desk.session.replace_state(load_variant(self.project, self._name()).state)
        self.desk.replaced()

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
            self.portraits.draw(variant.name)
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


def picture_html(path: Path, name: str) -> str:
    """The thumbnail of a variant as HTML; nothing where its file is gone."""
    try:
        data = base64.b64encode(path.read_bytes()).decode()
    except OSError:
        return ""
    words = html.escape(f"{name}: at rest, pressed, image", quote=True)
    return (
        f"<img src='data:image/png;base64,{data}' alt='{words}' title='{words}' "
        "style='width:100%;min-width:0;border-radius:4px;margin-top:4px;display:block'>"
    )


def offer(handle: Any, names: Sequence[str], *, preferred: str = "") -> None:
    """Offer names in a drop-down; the one chosen stays where it still is among them."""
    now = preferred or handle.value
    if tuple(handle.options) != tuple(names):
        handle.options = tuple(names)
    wanted = now if now in names else names[0]
    if handle.value != wanted:
        handle.value = wanted
