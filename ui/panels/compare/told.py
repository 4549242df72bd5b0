"""The folder of tasks: what A and B tell apart by touch, as `workbench task` found it."""

from __future__ import annotations

import shlex

from ui.desk.desk import Desk
from ui.page.plain import plain
from ui.panels.compare.versus import short
from workbench.variants.comparison_side import NOW, Side
from workbench.variants.kept_tasks import earlier, kept
from workbench.variants.told_apart import told_html
from workbench.variants.variants import variant_path

EXAMPLE = "objects"
"""The task that the command names."""


class ToldFolder:
    """Widgets of the folder."""

    def __init__(self, desk: Desk) -> None:
        self.desk = desk
        gui = desk.server.gui
        with gui.add_folder("What they tell apart", expand_by_default=False):
            self.words = gui.add_markdown("")
            self.tables = gui.add_html("")
        self.show(None, None)

    def show(self, a: Side | None, b: Side | None) -> None:
        """Show what tasks found of both."""
        if a is None or b is None:
            self.words.content, self.tables.content = "Choose A and B.", ""
            return
        project = self.desk.session.project
        found = [kept(project, side.state.design) for side in (a, b)]
        self.tables.content = told_html(found[0], found[1], (short(a), short(b)))
        missing = [self._missing(side) for side, own in zip((a, b), found, strict=True) if not own]
        head = "Scores on renders at places that training did not show, ± over three seeds; null: \
without a network."
        self.words.content = "\n\n".join([head, *missing] if self.tables.content else missing)

    def _missing(self, side: Side) -> str:
        """How a design comes to have results."""
        project = self.desk.session.project
        before = earlier(project, side.state.design)
        name = plain(short(side))
        why = f"No task was run on {name}."
        if before:
            tasks = ", ".join(before)
            why = f"{name} has changed since {tasks} was run: what it told then is not shown."
        path = variant_path(project, side.name) if side.name != NOW else None
        design = "NAME" if path is None else shlex.quote(str(path))
        where = shlex.quote(str(project.folder))
        words = ("workbench task", EXAMPLE, design, "--out", f"told/{EXAMPLE}", "--project", where)
        saved = "Save the design as a file or a variant and type" if path is None else "Type"
        return f"{why} {saved}\n\n```\n{' '.join(words)} --no-twin\n```"
