"""The folder that starts, watches, stops and goes on with searches."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import viser

from ui.desk.desk import Desk
from ui.page.offer import offer
from ui.page.plain import plain
from ui.panels.search.run import SearchRun
from workbench.core.base.errors import DesignError
from workbench.core.base.units import human_seconds
from workbench.search.kept_searches import (
    NOTHING,
    Asked,
    Standing,
    list_searches,
    new_search,
    search_folder,
    standing,
)
from workbench.system.names import NONE, numbered

FEWEST, MOST, USUAL = 4, 200, 40
"""Designs of a search that is started here; a file may ask for more."""


class RunFolder:
    """Widgets of the folder."""

    def __init__(
        self, desk: Desk, asked: Callable[[], Asked], on_change: Callable[[str, Standing], None]
    ) -> None:
        self.desk, self.asked, self.on_change = desk, asked, on_change
        self.project = desk.session.project
        self.run = SearchRun(self.project)
        self._seen: tuple[str, int] = (NONE, 0)
        """Search on show, and when its files were written."""
        self._told = ""
        """What the summary of that says."""
        self._was_busy = False
        gui, guarded = desk.server.gui, desk.guarded
        with gui.add_folder("Search"):
            hint = "Computed in all; designs that a cheap check refuses are not counted"
            self.trials = gui.add_slider("Designs to compute", FEWEST, MOST, 1, USUAL, hint=hint)
            hint = "Looks for designs like this one that do better; works beside all else"
            self.start = gui.add_button("Start search", icon=viser.Icon.SEARCH, hint=hint)
            self.start.on_click(guarded(self._begin))
            self.progress = gui.add_markdown("")
            hint = "What was computed is kept; the design that is computed now is lost"
            self.stop = gui.add_button("Stop search", color="red", visible=False, hint=hint)
            self.stop.on_click(guarded(lambda event: self.run.stop()))
            self.choice = gui.add_dropdown("Search to show", (NONE,), hint="Those of this project")
            self.choice.on_update(guarded(lambda event: self._show()))
            hint = "Computes more, up to Designs to compute"
            self.resume = gui.add_button("Continue search", visible=False, hint=hint)
            self.resume.on_click(guarded(self._continue))
        desk.on_turn.append(self._turn)
        self._offer()

    def _offer(self, preferred: str = "") -> None:
        offer(self.choice, (NONE, *list_searches(self.project)), preferred=preferred)

    def _begin(self, event: Any) -> None:
        self._refuse_two()
        self.desk.reports.begin()
        self.desk.fields.read_typed(now=True)
        state = self.desk.session.state
        name = numbered(state.design.name, list_searches(self.project), first=1)
        new_search(self.project, name, state, self.asked())
        self.run.start(name, int(self.trials.value))
        self.desk.log(f"search {name}: started")
        self._offer(name)
        self._show()

    def _continue(self, event: Any) -> None:
        self._refuse_two()
        if self.choice.value == NONE:
            raise DesignError("no search is chosen", hint="choose one in Search to show")
        self.run.start(self.choice.value, int(self.trials.value))
        self.desk.log(f"search {self.choice.value}: goes on")
        self._show()

    def _refuse_two(self) -> None:
        if self.run.busy:
            raise DesignError("a search runs already", hint="wait for it, or press Stop search")

    @property
    def folder(self) -> Path | None:
        """Of the search on show."""
        name = self.choice.value
        return None if name == NONE else search_folder(self.project, name)

    def _turn(self) -> None:
        """Follow the files of the search on show, and say how far the one that runs is."""
        busy = self.run.busy
        if busy or self._was_busy or self._stamp() != self._seen:
            self._show()
        if self._was_busy and not busy:
            self.desk.log(f"search {self.run.name}: {self.run.ending}")
            if self.run.error is not None:
                self.desk.reports.report(self.run.error)
        self._was_busy = busy

    def _stamp(self) -> tuple[str, int]:
        folder = self.folder
        if folder is None:
            return NONE, 0
        path = folder / "summary.json"
        return folder.name, path.stat().st_mtime_ns if path.exists() else 0

    def _show(self) -> None:
        busy, folder = self.run.busy, self.folder
        shown = (
            (self.stop, busy),
            (self.start, not busy),
            (self.resume, not busy and bool(folder)),
        )
        for handle, wanted in shown:
            if handle.visible != wanted:
                handle.visible = wanted
        stamp = self._stamp()
        if stamp != self._seen:
            found = NOTHING if folder is None else standing(folder)
            self._seen = stamp
            self._told = _told(found)
            self.on_change("" if folder is None else folder.name, found)
        words = self._words(busy)
        if self.progress.content != words:
            self.progress.content = words

    def _words(self, busy: bool) -> str:
        """How far the search is, and how many designs it has."""
        if busy:
            spent = human_seconds(self.run.seconds)
            share = f"{100.0 * self.run.fraction:.0f} %"
            head = f"**{plain(self.run.name)}: {share}**, {spent} · {plain(self.run.note)}"
        else:
            head = self.run.ending
        return "\n\n".join(part for part in (head, self._told) if part)


def _told(found: Standing) -> str:
    """What stands in the summary of a search."""
    about = found.summary
    if not about:
        return ""
    count = {name: about.get("computed", {}).get(name, 0) for name in ("press", "bake", "shoot")}
    reused = {name: about.get("found", {}).get(name, 0) for name in ("press", "bake", "shoot")}
    saved = ", ".join(
        f"{label} {count[name]} computed and {reused[name]} found"
        for name, label in (("press", "presses"), ("bake", "bakes"), ("shoot", "images"))
        if count[name] or reused[name]
    )
    words = (
        f"{about.get('trials', 0)} designs computed, {about.get('refused', 0)} refused, "
        f"{about.get('front', 0)} on the front"
    )
    return f"{words}; {saved}." if saved else f"{words}."
