"""The folder of the score card: figures of the listed variants and of the design as it stands."""

from __future__ import annotations

import html

from ui.desk.desk import Desk
from ui.page.offer import offer
from ui.patches.leading import empty_state
from workbench.variants.comparison_tables import card_table, remedies, scrolled
from workbench.variants.score_card import Figures, card, sorted_by
from workbench.view.metric_rules import RULES

BY_NAME = "name"
SORTS = {BY_NAME: "", **{rule.label: name for name, rule in RULES.items() if rule.stage}}
"""What the card can be sorted by, as people call it."""
NOW_SHORT = "as it stands"
NOTHING = empty_state(
    "The score card sets designs side by side: press this one, save it as a variant, change "
    "something and press again.",
    "Run press (R)",
    key="r",
)
"""What stands in place of a table of dashes."""


class ScoreFolder:
    """Widgets of the folder."""

    def __init__(self, desk: Desk) -> None:
        self.designs: list[tuple[str, Figures]] = []
        gui = desk.server.gui
        with gui.add_folder("Score card"):
            hint = "The best comes first; of a neutral figure the lowest"
            self.empty = gui.add_html(NOTHING)
            self.sort = gui.add_dropdown("Sort by", tuple(SORTS), hint=hint)
            self.sort.on_update(desk.guarded(lambda event: self._draw()))
            hint = "Otherwise those that decide: force, signal, view, light, mass, checks"
            self.every = gui.add_checkbox("All figures", False, hint=hint)
            self.every.on_update(desk.guarded(lambda event: self._draw()))
            self.table = gui.add_html("")

    def load(self, designs: list[tuple[str, Figures]]) -> None:
        """Show these designs: name and figures of each."""
        if designs != self.designs:
            self.designs = designs
            offer(self.sort, tuple(SORTS))
            self._draw()

    def _offer(self, known: bool) -> None:
        """Show the card, or what to do for one."""
        self.empty.visible = not known
        for handle in (self.sort, self.every, self.table):
            handle.visible = known

    def _draw(self) -> None:
        metric = SORTS[self.sort.value]
        order = sorted_by(self.designs, metric) if metric else self.designs
        if not any(figures for _, figures in self.designs):
            self._offer(False)
            return
        self._offer(True)
        shown = card(order, chief_only=not self.every.value)
        words = "↑ higher is better, ↓ lower is better, – neutral: rest on a figure for the reason"
        words = f"★ best; {words}. {remedies(shown)}"
        note = f"<p style='font-size:12px;opacity:.75;margin:4px 8px'>{html.escape(words)}</p>"
        self.table.content = scrolled(card_table(shown)) + note
