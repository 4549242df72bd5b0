"""Draws the thumbnails of variants in the background, one after the other.

The drawing itself runs in the `cad` worker; this thread only waits for it, holds no lock of the
desk meanwhile, and says when the file is there. A machine that cannot render leaves a thumbnail of
the tactile image alone.
"""

from __future__ import annotations

import queue
import threading
from collections.abc import Callable
from typing import Any

from ui.desk.reports import Reports
from workbench.core.base.errors import Cancelled, WorkbenchError
from workbench.core.base.monitor import silent
from workbench.live.job_thread import Runner
from workbench.project.project import Project
from workbench.report.thumbnails import thumbnail_calls, thumbnail_png
from workbench.system.whole_files import write_atomically
from workbench.variants.variants import load_variant, result_keys, variant_path


class ThumbnailQueue:
    """A queue of variants without thumbnails and the thread that works it off."""

    def __init__(self, project: Project, runner: Runner, reports: Reports) -> None:
        self.project = project
        self.runner = runner
        self.reports = reports
        self.on_drawn: Callable[[], None] = lambda: None
        """Set by the panel: a file has come."""
        self._waiting: queue.Queue[str] = queue.Queue()
        threading.Thread(target=self._loop, name="thumbnails", daemon=True).start()

    def draw(self, name: str) -> None:
        """Draw the thumbnail of a variant when its turn comes."""
        self._waiting.put(name)

    def _loop(self) -> None:
        while True:
            name = self._waiting.get()
            try:
                self._draw(name)
            except Cancelled:
                return
            except WorkbenchError as error:
                # A variant without a thumbnail is still a variant.
                self.reports.log(f"no thumbnail of {name}: {error.message}")
            except Exception as bug:
                # The thread must outlive a bug, and the designer must hear of it.
                self.reports.crash(bug)
            self.reports.guarded(lambda event: self.on_drawn())(None)

    def _draw(self, name: str) -> None:
        keys = result_keys(self.project, load_variant(self.project, name))
        unable: Any = None
        for call in thumbnail_calls(self.project.store, keys):
            try:
                self.runner.run(call, silent)
            except Cancelled:
                raise
            except WorkbenchError as error:
                unable = error
        content = thumbnail_png(self.project.store, keys)
        if content is not None:
            # Renamed or deleted meanwhile, it has no place any more.
            path = variant_path(self.project, name)
            if path.exists():
                write_atomically(path.with_suffix(".png"), content)
        if unable is not None:
            self.reports.log(f"thumbnail of {name}: {unable.message}")
