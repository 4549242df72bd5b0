"""The front of a search: its plot, figures of its designs, and how one becomes a variant."""

from __future__ import annotations

import html
from typing import Any

import viser

from ui.desk.desk import Desk
from ui.page.offer import offer
from workbench.core.base.errors import DesignError
from workbench.report.html_page import table
from workbench.search.kept_searches import NOTHING, Standing, design_of, search_folder
from workbench.search.search_figures import KNOWN
from workbench.system.names import NONE, numbered
from workbench.variants.variant_files import list_variants
from workbench.variants.variants import save_variant


class OutcomeFolder:
    """Widgets of the folder."""

    def __init__(self, desk: Desk) -> None:
        self.desk = desk
        self.project = desk.session.project
        self.name = ""
        self.found = NOTHING
        gui, guarded = desk.server.gui, desk.guarded
        self.folder = gui.add_folder("Best designs", visible=False)
        with self.folder:
            self.plot = gui.add_html("")
            hint = "Designs that no other beats in every goal, the best of the first goal first"
            self.design = gui.add_dropdown("Design of the front", (NONE,), hint=hint)
            self.design.on_update(guarded(lambda event: self._tell()))
            self.figures = gui.add_html("")
            hint = "Keeps it among the variants and shows it; Undo returns"
            keep = gui.add_button("Open as variant", icon=viser.Icon.FOLDER_OPEN, hint=hint)
            keep.on_click(guarded(self._open))
            self.where = gui.add_markdown("")

    def load(self, name: str, found: Standing) -> None:
        """Show a search as it stands."""
        self.name, self.found = name, found
        self.folder.visible = bool(found.front)
        self.plot.content = f"<div style='background:#fff;margin:4px 8px'>{found.plot}</div>"
        offer(self.design, tuple(row["name"] for row in found.front) or (NONE,))
        if name:
            folder = search_folder(self.project, name)
            self.where.content = f"Report, table and journal: `{folder}`"
        self._tell()

    def _row(self) -> dict[str, Any] | None:
        found = (row for row in self.found.front if row["name"] == self.design.value)
        return next(found, None)

    def _tell(self) -> None:
        """Figures of the goals and parameters of the chosen design."""
        row = self._row()
        if row is None:
            self.figures.content = ""
            return
        goals = self.found.summary.get("goals", [])
        lines = [(_titled(name), row["figures"][name]) for name in goals if name in row["figures"]]
        confirmed = row.get("confirmed", {})
        for name in goals:
            if name in confirmed.get("figures", {}):
                lines.append((f"{_titled(name)}, confirmed", confirmed["figures"][name]))
        lines += [
            (name.removeprefix("design."), row["parameters"][name]) for name in row["parameters"]
        ]
        note = "" if confirmed.get("holds", True) else f"<p>{html.escape(confirmed['reason'])}</p>"
        self.figures.content = (
            f"<div style='margin:4px 8px;font-size:12px'>{table(lines)}{note}</div>"
        )

    def _open(self, event: Any) -> None:
        row = self._row()
        if row is None:
            raise DesignError("no design is chosen", hint="choose one in Design of the front")
        state = design_of(self.project, search_folder(self.project, self.name), row)
        name = numbered(f"{self.name} {row['name']}", list_variants(self.project))
        save_variant(self.project, name, state, tags=(self.name,))
        self.desk.session.replace_state(state)
        self.desk.replaced()
        self.desk.log(f"variant {name} saved and opened")


def _titled(figure: str) -> str:
    about = KNOWN.get(figure)
    if about is None:
        return figure
    return f"{about.label} [{about.unit}]" if about.unit else about.label
