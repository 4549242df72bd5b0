"""Progress of a training on a terminal."""

from __future__ import annotations

import json
import sys
import time
from typing import TYPE_CHECKING

from workbench.core.base.units import human_seconds
from workbench.system.terminal import complain, say

if TYPE_CHECKING:
    from workbench.learning.training.plan import TrainingProgress

TOLD_S = 10.0
"""Time between two lines of progress where there is no terminal to rewrite one [s]."""


class TrainingLine:
    """Progress of a training: one line that is rewritten, or one every few seconds."""

    def __init__(self, *, as_json: bool) -> None:
        self.as_json = as_json
        self.rewrites = not as_json and sys.stderr.isatty()
        self._said_s = 0.0
        self._shown = ""
        self._notes = 0

    def tell(self, progress: TrainingProgress) -> None:
        """Show an epoch that ended."""
        for note in progress.notes[self._notes :]:
            self.end()
            complain(f"note: {note}")
        self._notes = len(progress.notes)
        if self.as_json:
            say(json.dumps({"stage": "train", "eta_s": progress.eta_s, **progress.row}))
            return
        row = progress.row
        line = f"epoch {row['epoch']} of {progress.epochs}: loss {row['train_loss']:.3f}"
        if row["validation_mae"] is not None:
            line += f", validation {row['validation_mae']:.3g} (zero {row['zero_mae']:.3g}"
            line += f", contact solver {row['mpm_mae']:.3g})" if row["mpm_mae"] else ")"
        line += f", {human_seconds(progress.eta_s)} left"
        now, last = time.monotonic(), row["epoch"] == progress.epochs
        if self.rewrites:
            complain(f"\r\x1b[K{line}", end="")
            self._shown = line
        elif now - self._said_s >= TOLD_S or last:
            self._said_s = now
            complain(line)

    def within(self, fraction: float, note: str = "") -> None:
        """Show how far an epoch is."""
        if self.rewrites and time.monotonic() - self._said_s > 1.0:
            self._said_s = time.monotonic()
            complain(f"\r\x1b[K{self._shown or 'epoch 1'} ({100 * fraction:.0f} %)", end="")

    def end(self) -> None:
        """Leave the line that is rewritten."""
        if self.rewrites and self._shown:
            complain("")
            self._shown = ""
