"""Plays frames at a steady pace: one thread that moves the frame's slider, at a chosen speed.

Frames that could not be shown in time are left out, so that a slow page loses frames, not time.
"""

from __future__ import annotations

import threading
import time
from typing import Any

FRAME_S = 0.08
"""Time between frames at speed 1 [s]: 12 a second, which software rendering keeps up with."""
SPEEDS = {"0.25 ×": 0.25, "0.5 ×": 0.5, "1 ×": 1.0, "2 ×": 2.0, "4 ×": 4.0}


class Player:
    """Moves a slider from 0 to its end, once or again and again."""

    def __init__(self, slider: Any) -> None:
        self.slider = slider
        self.speed = 1.0
        self.loop = False
        self._playing = threading.Event()
        threading.Thread(target=self._play_forever, name="player", daemon=True).start()

    @property
    def playing(self) -> bool:
        """Whether frames are moving."""
        return self._playing.is_set()

    def start(self) -> None:
        """Play on, or from the beginning where the end has been reached."""
        if not self.loop and int(self.slider.value) >= int(self.slider.max):
            self.slider.value = 0
        self._playing.set()

    def stop(self) -> None:
        """Stop at the frame on show."""
        self._playing.clear()

    def step(self, frames: int) -> None:
        """Stop, and go some frames on or, if negative, back."""
        self.stop()
        self.slider.value = min(max(int(self.slider.value) + frames, 0), int(self.slider.max))

    def _play_forever(self) -> None:
        while self._playing.wait():
            due_s = time.monotonic()
            while self._playing.is_set():
                period_s = FRAME_S / self.speed
                due_s += period_s
                late_s = time.monotonic() - due_s
                if late_s < 0.0:
                    time.sleep(-late_s)
                missed = max(0, int(late_s / period_s))
                due_s += missed * period_s
                if self._playing.is_set():
                    self._advance(1 + missed)

    def _advance(self, frames: int) -> None:
        now, count = int(self.slider.value), int(self.slider.max)
        number, more = advanced(now, count, frames, loop=self.loop)
        if not more:
            self._playing.clear()
        self.slider.value = number


def advanced(number: int, count: int, frames: int, *, loop: bool) -> tuple[int, bool]:
    """The frame after `frames` more, of 0 to `count`, and whether playing goes on."""
    if number + frames < count or loop:
        return (number + frames) % (count + 1), True
    return count, False
