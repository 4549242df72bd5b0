"""The headline above all pages follows the figures of the design as it stands."""

from __future__ import annotations

from collections.abc import Mapping

from ui.desk.desk import Desk
from ui.page.headline_html import headline_html
from workbench.core.base.errors import DesignError
from workbench.project.limits import read_limits
from workbench.view.headline import Bounds, headlines


class HeadlineRow:
    """What stands in the row; figures come from the page that compares."""

    def __init__(self, desk: Desk) -> None:
        self.desk = desk
        self.figures: dict[str, float] = {}
        """Those of the design as it stands."""
        self.before: dict[str, float] = {}
        """Last known of each figure."""
        self.limits: dict[str, Bounds] = {}
        self.read_limits()
        desk.figured.connect(self.take)
        desk.limited.connect(self.follow_limits)
        self.draw()

    def follow_limits(self) -> None:
        """The project's limits have changed."""
        self.read_limits()
        self.draw()

    def read_limits(self) -> None:
        """Take the project's own limits, unless their file cannot be read; that is said."""
        try:
            self.limits = read_limits(self.desk.session.project.folder)
        except DesignError as error:
            self.limits = {}
            self.desk.log(f"{error.message}: {error.hint}")

    def take(self, figures: Mapping[str, float]) -> None:
        """Show figures of the design as it stands; what is not known anew keeps its last value."""
        self.figures = dict(figures)
        self.before |= figures
        self.draw()

    def forget(self) -> None:
        """Another sensor: nothing is known of it."""
        self.figures, self.before = {}, {}
        self.draw()

    def draw(self) -> None:
        """Write the row, if it says anything else than before."""
        text = headline_html(headlines(self.figures, self.limits, before=self.before))
        if self.desk.header.headline.content != text:
            self.desk.header.headline.content = text
