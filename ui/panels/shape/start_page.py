"""The start page: pictures of all that work can begin with, each one click from its page.

It opens by *Start*, which stands above all pages, and by a key; never by itself: whoever comes back
finds the sensor as it was left, and a newcomer a sensor that is pressed, with a tour beside it.
"""

from __future__ import annotations

from typing import Any

from ui.desk.desk import Desk
from ui.page.gallery import Card
from ui.page.header import HOME_KEY
from ui.panels.shape.design_files import DesignFiles, shipped_cards
from workbench.project.saved_designs import SavedDesign, file_stamp
from workbench.report.thumbnails import first_tile
from workbench.variants.variant_files import Entry, Shelf
from workbench.variants.variants import load_variant, variant_path

TITLE = "Start"
OWN = "Go on with one of yours"
SHIPPED = "Begin with one that ships"
OTHER = "Begin with what you have"
VARIANT = " (variant)"
"""Ends the card of a variant."""
MOST_RECENT = 4
"""Kept designs and variants on show, the latest first; the galleries have all."""
WAYS = (
    Card(
        name="Import a body",
        words="STEP or STL of your own",
        icon="body",
        goto="Shape",
        fold="Own body (STEP or STL)",
        group=OTHER,
    ),
    Card(
        name="Read a photo",
        words="Depth and force from a built sensor",
        icon="photo",
        goto="Read",
        group=OTHER,
    ),
    Card(
        name="Search by goals",
        words="Say what matters, let designs be found",
        icon="goals",
        goto="Search",
        group=OTHER,
    ),
)
"""Begin elsewhere than with a design."""


class StartPage:
    """The window and its key."""

    def __init__(self, desk: Desk, files: DesignFiles) -> None:
        self.desk, self.files = desk, files
        self.project = desk.session.project
        self.shelf = Shelf(self.project)
        command = desk.server.gui.add_command("Start page", hotkey=HOME_KEY.upper())
        command.on_trigger(desk.guarded(self._open))

    def _open(self, event: Any) -> None:
        desk = self.desk
        desk.galleries.show(event.client, TITLE, self.cards(), desk.guarded(self.choose))

    def cards(self) -> tuple[Card, ...]:
        """All of them: yours, what ships, and other ways to begin."""
        return (*self._recent(), *shipped_cards(SHIPPED), *WAYS)

    def _recent(self) -> list[Card]:
        """What was kept last in this project, designs and variants alike."""
        found: list[tuple[int, SavedDesign | Entry]] = []
        for design in self.files.shelf.entries():
            stamp = file_stamp(self.project, design.name)
            found.append((stamp[0] if stamp else 0, design))
        for entry in self.shelf.entries():
            if entry.variant is not None and variant_path(self.project, entry.name).is_file():
                when = variant_path(self.project, entry.name).stat().st_mtime_ns
                found.append((when, entry))
        found.sort(key=lambda one: one[0], reverse=True)
        cards = []
        for _, one in found[:MOST_RECENT]:
            if isinstance(one, SavedDesign):
                cards += self.files.own_cards([one], OWN)
            elif one.variant is not None:
                # The membrane alone, as of what ships: three side by side would be tiny.
                png = first_tile(one.thumbnail.read_bytes()) if one.thumbnail is not None else None
                words = one.variant.state.design.family
                cards.append(Card(name=f"{one.name}{VARIANT}", words=words, png=png, group=OWN))
        return cards

    def choose(self, name: str) -> None:
        """Open what a card stands for."""
        if not name.endswith(VARIANT):
            self.files.choose(name)
            return
        self.desk.session.replace_state(
            load_variant(self.project, name.removesuffix(VARIANT)).state
        )
        self.files.forget()
        self.desk.replaced()
