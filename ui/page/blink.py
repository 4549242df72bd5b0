"""Two images that take each other's place at a steady pace; holds no lock of the desk.

Only their visibility changes, which costs a page nothing, and nothing at all is sent while no page
looks.
"""

from __future__ import annotations

import threading
import time
from typing import Any


class Blink:
    """Shows `first` and `second` in turn while it is on."""

    def __init__(self, server: Any, first: Any, second: Any, *, period_s: float) -> None:
        self.server = server
        self.first = first
        self.second = second
        self.period_s = period_s
        """How long each is shown [s]."""
        self._on = threading.Event()
        self._turning = threading.Lock()
        threading.Thread(target=self._loop, name="blink", daemon=True).start()

    def start(self) -> None:
        """Begin with the first, or go on."""
        with self._turning:
            if not self._on.is_set():
                self._show(first=True)
                self._on.set()

    def stop(self) -> None:
        """Leave the first on show; nothing turns once this has returned."""
        with self._turning:
            if self._on.is_set():
                self._on.clear()
                self._show(first=True)

    def _show(self, *, first: bool) -> None:
        with self.server.atomic():
            self.first.visible, self.second.visible = first, not first

    def _loop(self) -> None:
        while self._on.wait():
            time.sleep(self.period_s)
            with self._turning:
                if self._on.is_set() and self.server.get_clients():
                    self._show(first=not self.first.visible)
