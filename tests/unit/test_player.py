"""Playing: which frame comes next, and that it keeps time and stops at the end."""

from __future__ import annotations

import time
from types import SimpleNamespace

import pytest

from ui.page.player import FRAME_S, Player, advanced


@pytest.mark.parametrize(
    ("number", "frames", "loop", "expected"),
    [
        (0, 1, False, (1, True)),
        (3, 1, False, (4, False)),
        (4, 1, False, (4, False)),
        (2, 9, False, (4, False)),
        (3, 1, True, (4, True)),
        (4, 1, True, (0, True)),
        (4, 2, True, (1, True)),
    ],
)
def test_next_frame(number: int, frames: int, loop: bool, expected: tuple[int, bool]) -> None:
    """Of frames 0 to 4: stops at 4, or begins again with the rest."""
    assert advanced(number, 4, frames, loop=loop) == expected


def test_a_slow_page_loses_frames_not_time() -> None:
    """Showing takes 2.5 periods: 30 frames at speed 1 still last 2.4 s, with some left out."""

    class Slow(SimpleNamespace):
        shown: list[int]

        def __setattr__(self, name: str, value: int) -> None:
            super().__setattr__(name, value)
            if name == "value":
                self.shown.append(value)
                time.sleep(2.5 * FRAME_S)

    slider = Slow(max=30, shown=[])
    slider.__dict__["value"] = 0
    player = Player(slider)
    begun = time.monotonic()
    player.start()
    while player.playing and time.monotonic() - begun < 10.0:
        time.sleep(0.01)
    seconds = time.monotonic() - begun
    # A period early or late, and the noise of a busy machine.
    assert 30 * FRAME_S - 0.2 < seconds < 30 * FRAME_S + 1.0
    assert len(slider.shown) < 20
    assert slider.shown == sorted(slider.shown)


def test_steps_stop_at_both_ends() -> None:
    """Back from 0 is 0, on from the last is the last."""
    slider = SimpleNamespace(value=0, max=2)
    player = Player(slider)
    player.step(-1)
    assert slider.value == 0
    for expected in (1, 2, 2):
        player.step(1)
        assert slider.value == expected
    player.start()
    assert slider.value == 0
    player.stop()
