"""Progress of samples on a terminal."""

from __future__ import annotations

import dataclasses
import json
import sys
import time
from typing import Any

from workbench.core.base.units import human_seconds
from workbench.system.terminal import complain, say

TOLD_S = 10.0
"""Time between two lines of progress where there is no terminal to rewrite one [s]."""


class SampleLine:
    """Progress of samples: one line that is rewritten, or one every few seconds."""

    def __init__(self, *, as_json: bool) -> None:
        self.as_json = as_json
        self.rewrites = not as_json and sys.stderr.isatty()
        self._said_s = 0.0
        self._shown = ""

    def tell(self, progress: Any) -> None:
        """Show how far it is."""
        if self.as_json:
            line = json.dumps({"stage": "samples", **dataclasses.asdict(progress)})
        else:
            left = "" if progress.eta_s is None else f", {human_seconds(progress.eta_s)} left"
            bad = f", {progress.failed} cases failed" if progress.failed else ""
            line = f"{progress.done} of {progress.total} samples{left}{bad}"
        now = time.monotonic()
        if line == self._shown or (not self.rewrites and now - self._said_s < TOLD_S):
            return
        self._said_s, self._shown = now, line
        if self.as_json:
            say(line)
        elif self.rewrites:
            complain(f"\r\x1b[K{line}", end="")
        else:
            complain(line)

    def end(self) -> None:
        """Leave the line that is rewritten."""
        if self.rewrites and self._shown:
            complain("")
