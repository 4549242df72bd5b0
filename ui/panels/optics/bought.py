"""A list of bought parts: the one chosen sets its numbers, the one that has them is shown."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from ui.desk.desk import Desk
from ui.page.callbacks import put
from workbench.core.design.design import SensorDesign

OWN = "own numbers"


class Bought:
    """A dropdown; `name` says which part the design has, `take` puts one into it."""

    def __init__(
        self,
        desk: Desk,
        label: str,
        titles: Mapping[str, str],
        *,
        name: Callable[[], str],
        take: Callable[[SensorDesign, str], SensorDesign],
    ) -> None:
        self.desk, self.name, self.take = desk, name, take
        self.titles = {**titles, "": OWN}
        self.names = {title: part for part, title in self.titles.items()}
        hint = "One that can be bought; docs/parts.md says where its numbers are from"
        choices = (OWN, *titles.values())
        self.choice = desk.server.gui.add_dropdown(label, choices, initial_value=OWN, hint=hint)
        self.choice.on_update(desk.guarded(self._choose))

    def _choose(self, event: Any) -> None:
        part = self.names[self.choice.value]
        if event.client is None or not part:
            self.refresh()
            return
        desk = self.desk
        desk.session.change_design(self.take(desk.session.design, part))
        desk.reports.settle()
        desk.fields.refresh()
        desk.changed()
        self.refresh()

    def refresh(self) -> None:
        """Show the part whose numbers the design has."""
        put(self.choice, self.titles[self.name()])
