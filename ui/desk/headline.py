"""The headline above all pages follows the figures of the design as it stands."""

from __future__ import annotations

from collections.abc import Mapping

from ui.desk.desk import Desk
from ui.page.headline_html import headline_html
from workbench.core.base.errors import DesignError
from workbench.core.base.units import ML_PER_MM3
from workbench.core.result.fabrication import Severity
from workbench.project.limits import read_limits
from workbench.project.prices import Prices, parts_cost, read_prices
from workbench.view.headline import COST_RULE, LOOK_AT, MAKEABLE, Bounds, headlines
from workbench.view.part_words import part_words

CHECKED = {"mould": "the mould", "housing": "the housing", "recipe": "the casting"}
"""Stages whose checks say whether a design can be made."""


class HeadlineRow:
    """What stands in the row; figures come from the page that compares."""

    def __init__(self, desk: Desk) -> None:
        self.desk = desk
        self.figures: dict[str, float] = {}
        """Those of the design as it stands."""
        self.before: dict[str, float] = {}
        """Last known of each figure."""
        self.limits: dict[str, Bounds] = {}
        self.prices: Prices | None = None
        self._named: tuple[Mapping[str, str], list[str]] = {}, []
        """Keys of the parts that were looked at last, and what did not pass of them."""
        self.read_limits()
        desk.figured.connect(self.take)
        desk.limited.connect(self.follow_limits)
        self.draw()

    def follow_limits(self) -> None:
        """The project's limits or prices have changed."""
        self.read_limits()
        for known in (self.figures, self.before):
            known.pop(COST_RULE.name, None)
        self.take(self.figures)

    def read_limits(self) -> None:
        """Take the project's own limits and prices; a file that cannot be read is told of."""
        folder = self.desk.session.project.folder
        self.limits, self.prices = {}, None
        try:
            self.limits = read_limits(folder)
            self.prices = read_prices(folder)
        except DesignError as error:
            self.desk.log(f"{error.message}: {error.hint}")

    def take(self, figures: Mapping[str, float]) -> None:
        """Show figures of the design as it stands; what is not known anew keeps its last value."""
        self.figures = {**figures, **self._cost(figures)}
        self.before |= self.figures
        self.draw()

    def _cost(self, figures: Mapping[str, float]) -> dict[str, float]:
        """What the parts cost, where prices and the volume of the skin are known."""
        millilitres = figures.get("membrane_ml")
        if self.prices is None or millilitres is None:
            return {}
        design = self.desk.session.design
        return {COST_RULE.name: parts_cost(design, millilitres / ML_PER_MM3, self.prices)}

    def forget(self) -> None:
        """Another sensor: nothing is known of it."""
        self.figures, self.before = {}, {}
        self.draw()

    def draw(self) -> None:
        """Write the row, if it says anything else than before."""
        shown = headlines(
            self.figures,
            self.limits,
            before=self.before,
            unmade=self._unmade(),
            checks=self._failing(),
        )
        text = headline_html(shown)
        if self.desk.header.headline.content != text:
            self.desk.header.headline.content = text

    def _unmade(self) -> list[str]:
        """Parts of the design as it stands whose checks its figures lack; asked at every edit."""
        if MAKEABLE not in self.figures:
            return []
        session = self.desk.session
        calls = session.calls()
        return [
            words
            for stage, words in CHECKED.items()
            if stage in calls and not session.store.has(stage, calls[stage].key)
        ]

    def _failing(self) -> list[str]:
        """Checks of the design as it stands that did not pass, the worst first, in words."""
        if not (self.figures.get(MAKEABLE) or self.figures.get(LOOK_AT)):
            return []
        session = self.desk.session
        calls = session.calls()
        made = {stage: calls[stage].key for stage in CHECKED if stage in calls}
        made = {stage: key for stage, key in made.items() if session.store.has(stage, key)}
        # Figures come at every edit of the press too, and parts are heavy to read.
        if self._named[0] != made:
            self._named = made, self._names(made)
        return self._named[1]

    def _names(self, made: Mapping[str, str]) -> list[str]:
        """Of the checks that did not pass, of stages that are stored."""
        results = [self.desk.session.result(stage) for stage in made]
        checks = [check for result in results if result is not None for check in result.checks]
        return [
            f"{check.name.replace('_', ' ')} ({part_words(check.part)})"
            for severity in (Severity.BAD, Severity.WARNING)
            for check in checks
            if check.severity is severity
        ]
