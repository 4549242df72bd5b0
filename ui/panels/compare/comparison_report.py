"""The button that hands a comparison out as one HTML file."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Any

import viser

from ui.desk.desk import Desk
from workbench.core.base.errors import DesignError, WorkbenchError
from workbench.variants.comparison_report import Reported, called, comparison_page
from workbench.variants.comparison_side import Side

What = tuple[Side | None, Side | None, Reported]


class ReportFolder:
    """Widgets of the folder."""

    def __init__(self, desk: Desk, what: Callable[[], What]) -> None:
        self.desk = desk
        self.what = what
        gui = desk.server.gui
        with gui.add_folder("Report"):
            hint = "A, B, score card and the sweep on show; one file, to print or to send"
            icon = viser.Icon.DOWNLOAD
            export = gui.add_button("Export comparison (HTML)", icon=icon, hint=hint)
        export.on_click(desk.guarded(self._export))

    def _export(self, event: Any) -> None:
        a, b, more = self.what()
        if a is None or b is None:
            raise DesignError("there is nothing to compare", hint="choose A and B first")
        work = (event.client, a, b, more)
        threading.Thread(target=self._write, args=work, name="report", daemon=True).start()

    def _write(self, client: Any, a: Side, b: Side, more: Reported) -> None:
        """Make the page and send it; images are encoded without the desk's lock."""
        try:
            page = comparison_page(self.desk.session.store, a, b, more)
        except WorkbenchError as error:
            # Under the lock again, which the report of an error needs.
            self.desk.guarded(self.desk.reports.report)(error)
            return
        name = f"{called(a)} against {called(b)}.html"
        client.send_file_download(name, page.encode(), save_immediately=True)
        self.desk.guarded(lambda event: self.desk.log(f"report written: {name}"))(None)
