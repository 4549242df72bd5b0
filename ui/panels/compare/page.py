"""Compare: variants, score card, two against each other, what they tell apart, sweeps, reports."""

from __future__ import annotations

import threading
from pathlib import Path
from typing import Any

from ui.desk.desk import Desk
from ui.panels.compare.comparison_report import ReportFolder
from ui.panels.compare.limits import LimitsFolder
from ui.panels.compare.prices import PricesFolder
from ui.panels.compare.score_card import NOW_SHORT, ScoreFolder
from ui.panels.compare.sweep import SweepFolder
from ui.panels.compare.told import ToldFolder
from ui.panels.compare.variants import VariantsFolder
from ui.panels.compare.versus import VersusFolder
from ui.panels.page import Page
from workbench.core.base.errors import WorkbenchError
from workbench.project.state import State
from workbench.variants.comparison_report import Reported
from workbench.variants.comparison_side import NOW, Side, side_as_it_stands, side_of_variant
from workbench.variants.score_card import Figures
from workbench.variants.variants import KEPT, load_variant

SETTLE_S = 0.4
"""Quiet time after which the design as it stands is compared anew [s]."""


class ComparePanel:
    """Widgets of the sixth tab."""

    def __init__(self, desk: Desk) -> None:
        self.desk = desk
        self._now: tuple[State, dict[str, str], Side] | None = None
        """State and keys of stored results that the design as it stands was read from, and it."""
        self._timer: threading.Timer | None = None
        self.variants = VariantsFolder(desk, self._listed)
        self.score = ScoreFolder(desk)
        self.limits = LimitsFolder(desk)
        self.prices = PricesFolder(desk)
        self.versus = VersusFolder(desk, self._side, self._thumbnail)
        self.variants.on_save = self.versus.fill
        self.told = ToldFolder(desk)
        self.versus.on_compare = self.told.show
        self.sweep = SweepFolder(desk, self._kept)
        self.report = ReportFolder(desk, self._reported)
        self.variants.list()

    def _listed(self) -> None:
        """Follow the files of variants."""
        entries = self.variants.entries
        self.versus.offer(tuple(entry.name for entry in entries if entry.variant is not None))
        self._score()

    def _kept(self, name: str) -> None:
        """A point of a sweep became a variant."""
        self.variants.thumbnails.draw(name)
        self.variants.list()

    def _reported(self) -> tuple[Side | None, Side | None, Reported]:
        """What stands in the report: both sides, the other variants, and the sweep on show."""
        a, b = self.versus.a, self.versus.b
        taken = {side.name for side in (a, b) if side is not None}
        others = tuple((name, values) for name, values in self._variants() if name not in taken)
        sweep, metric = self.sweep.shown()
        return a, b, Reported(others=others, sweep=sweep, metric=metric)

    def _variants(self) -> list[tuple[str, Figures]]:
        """Names and figures of the listed variants."""
        return [(e.name, e.variant.metrics) for e in self.variants.entries if e.variant is not None]

    def _score(self) -> None:
        figures = self._as_it_stands().figures
        self.desk.figured(figures)
        self.score.load([(NOW_SHORT, figures), *self._variants()])

    def _thumbnail(self, name: str) -> Path | None:
        """File of the thumbnail of a variant, if it has one."""
        found = (entry.thumbnail for entry in self.variants.shelf.entries() if entry.name == name)
        return next(found, None)

    def _side(self, name: str) -> Side | None:
        if name == NOW:
            return self._as_it_stands()
        project = self.desk.session.project
        try:
            return side_of_variant(project, load_variant(project, name))
        except WorkbenchError as error:
            self.desk.reports.report(error)
            return None

    def _as_it_stands(self) -> Side:
        """The design as it stands; read anew once it or what is stored of it has changed."""
        session = self.desk.session
        calls, store = session.calls(), session.store
        there = {s: calls[s].key for s in KEPT if s in calls and store.has(s, calls[s].key)}
        state, now = session.state, self._now
        # By identity: a state may hold arrays, and every edit makes another one.
        if now is None or now[0] is not state or now[1] != there:
            now = self._now = (state, there, side_as_it_stands(store, state, calls))
        return now[2]

    def refresh(self) -> None:
        """Follow the design as it stands, once it has rested: a drag must not wait for images."""
        if self._timer is not None:
            self._timer.cancel()
        self._timer = threading.Timer(SETTLE_S, self.desk.guarded(self._follow), (None,))
        self._timer.daemon = True
        self._timer.start()

    def _follow(self, event: Any) -> None:
        before = self._now
        self.sweep.refresh()
        self._score()
        chosen = (self.versus.choice_a.value, self.versus.choice_b.value)
        if NOW in chosen and self._now is not before:
            self.versus.compare()

    def show(self, stage: str, result: Any) -> None:
        """Follow results, another sensor in the view, and parts that cover it."""
        if stage in KEPT:
            self.refresh()
        elif stage == "sensor":
            self.versus.forget_view()
        elif stage == "covered":
            self.versus.cover(bool(result))


PAGE = Page(place=6, label="Compare", build=ComparePanel)
