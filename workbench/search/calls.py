"""What the browser asks a worker of its own: a search, which writes its files as it goes."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from workbench.core.base.monitor import Monitor
from workbench.core.base.packages import naming_packages
from workbench.live.preview_call import OwnCall
from workbench.pipeline.store import Store

SEARCH = "search"
"""The worker, and what messages call its work."""


@dataclass(frozen=True, kw_only=True, slots=True)
class SearchCall(OwnCall):
    """A search of a project, begun or gone on with; a `PreviewCall`."""

    project: Path
    """Folder of the project."""
    name: str
    trials: int
    """In all, those that there are already among them."""

    @property
    def lane(self) -> str:
        """The worker: one of its own, since a search takes hours."""
        return SEARCH

    @property
    def stage(self) -> str:
        """What messages call it."""
        return SEARCH

    def answer(self, store: Store, kept: dict[str, Any], monitor: Monitor) -> int:
        """Search; returns how many designs are on the front."""
        # The command line names a package that is missing by itself.
        with naming_packages():
            return self._searched(store, monitor)

    def _searched(self, store: Store, monitor: Monitor) -> int:
        from workbench.pipeline.devices import open_device
        from workbench.project.project import Project
        from workbench.search.kept_searches import kept_problem, search_folder
        from workbench.search.loop import Budget
        from workbench.search.running import run_search

        open_device()
        project = Project(self.project)
        project.store = store
        found = run_search(
            kept_problem(project, self.name),
            project,
            search_folder(project, self.name),
            Budget(trials=self.trials),
            monitor=monitor,
        )
        return len(found.front)
