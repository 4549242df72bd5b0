"""A search that runs in a worker of its own: started, watched, stopped, gone on with."""

from __future__ import annotations

import threading
import time

from workbench.core.base.errors import Cancelled, LaneError, WorkbenchError
from workbench.live.lanes import Lane
from workbench.project.project import Project
from workbench.search.calls import SEARCH, SearchCall


class SearchRun:
    """The one search of this server that runs, if any; its thread waits for the worker."""

    def __init__(self, project: Project) -> None:
        self.project = project
        self.name = ""
        """Of what runs, or ran last."""
        self.fraction, self.note = 0.0, ""
        self.ending = ""
        """How the last one ended, for people."""
        self.error: WorkbenchError | None = None
        """Why it did, until somebody has told it."""
        self._thread: threading.Thread | None = None
        self._stop = threading.Event()
        self._began = 0.0

    @property
    def busy(self) -> bool:
        """Whether one runs."""
        return self._thread is not None and self._thread.is_alive()

    @property
    def seconds(self) -> float:
        """Since the one that runs was started [s]."""
        return time.monotonic() - self._began

    def start(self, name: str, trials: int) -> None:
        """Begin a search of the project, or go on with it."""
        self.name, self.ending, self.error = name, "", None
        self.fraction, self.note = 0.0, "begins"
        self._stop.clear()
        self._began = time.monotonic()
        call = SearchCall(project=self.project.folder, name=name, trials=trials)
        self._thread = threading.Thread(target=self._work, args=(call,), name=SEARCH, daemon=True)
        self._thread.start()

    def stop(self) -> None:
        """Ask it to end; the running trial is lost, all others are kept."""
        self._stop.set()

    def _monitor(self, fraction: float, note: str = "") -> None:
        self.fraction, self.note = fraction, note or self.note
        if self._stop.is_set():
            raise Cancelled("stopped by the user")

    def _work(self, call: SearchCall) -> None:
        lane = Lane(SEARCH, self.project.store)
        try:
            count = lane.preview(call, self._monitor)
            self.ending = f"Finished: {count} designs on the front."
        except Cancelled:
            self.ending = "Stopped; *Continue search* goes on where it was."
        except WorkbenchError as error:
            self.ending, self.error = "Ended early.", error
        except Exception as bug:
            self.ending = "Ended early."
            self.error = LaneError(f"the search failed: {bug!r}", hint="start it again", at=SEARCH)
        finally:
            lane.close()
