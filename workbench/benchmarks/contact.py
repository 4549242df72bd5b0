"""Contact: the default press of the default finger, warm."""

from __future__ import annotations

from workbench.benchmarks.timing import timed_row
from workbench.core.design import Elastomer
from workbench.core.indenter import Indenter
from workbench.core.monitor import silent
from workbench.core.press import ContactSettings, Press
from workbench.rows import Row
from workbench.specimens import finger_mesh, finger_points
from workbench.stages import press


def rows() -> list[Row]:
    """All rows of the room."""
    from workbench.devices import open_device

    device = open_device()

    def run(frames: int) -> None:
        press(
            finger_mesh(),
            finger_points(),
            Elastomer(),
            Indenter(),
            Press(frames=frames),
            ContactSettings(),
            monitor=silent,
        )

    case = f"6 mm sphere, 1 mm deep, 0.5 mm grid, default region (8.3 mm), {device}"
    return [
        timed_row("one_frame", case, lambda: run(1), 3.0),
        timed_row("ten_frames", case, lambda: run(10), 8.0),
    ]
