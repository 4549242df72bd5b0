"""What each step of a task took, over all runs that were stopped and went on."""

from __future__ import annotations

import json
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from workbench.system.whole_files import write_atomically


class StepTimes:
    """Seconds by step, kept in a file."""

    def __init__(self, path: Path, key: str) -> None:
        """Go on from a file, or begin.

        Args:
            path: Of the file.
            key: Of the task: times of another one are forgotten.
        """
        self._path, self._key = path, key
        self._seconds = _read(path, key)

    @property
    def seconds(self) -> dict[str, float]:
        """Of each step, to a tenth."""
        return {name: round(value, 1) for name, value in self._seconds.items()}

    @contextmanager
    def of(self, name: str) -> Iterator[None]:
        """Add what happens inside to a step, also where it is stopped.

        Raises:
            StoreError: If the file cannot be written.
        """
        begun = time.monotonic()
        try:
            yield
        finally:
            taken = time.monotonic() - begun
            self._seconds[name] = self._seconds.get(name, 0.0) + taken
            table = {"key": self._key, "seconds": self._seconds}
            write_atomically(self._path, json.dumps(table).encode())


def _read(path: Path, key: str) -> dict[str, float]:
    try:
        table = json.loads(path.read_bytes())
        if table["key"] != key:
            return {}
        return {str(name): float(value) for name, value in table["seconds"].items()}
    except (OSError, ValueError, KeyError, TypeError, AttributeError):
        return {}
