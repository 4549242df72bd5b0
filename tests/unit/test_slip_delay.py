"""Delays of slip, and what the time alone tells of it."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from workbench.tasks.examples import Examples
from workbench.tasks.slip_delay import slip_delays, told_by_frame, within_frames
from workbench.tasks.splits import by_place


def slides(onsets: dict[str, int | None]) -> Examples:
    """Windows that end in frames 7 to 16 of slides that come to slip in a frame, or never."""
    rows = [(name, frame, onset) for name, onset in onsets.items() for frame in range(7, 17)]
    count = len(rows)
    return Examples(
        names=tuple(f"{name}:{frame}" for name, frame, _ in rows),
        places=np.array([name for name, _, _ in rows]),
        inputs=np.zeros((count, 8, 2, 2, 3), np.int16),
        at=np.zeros((count, 8), np.float32),
        feet_mm=np.zeros((count, 3)),
        axes=np.tile(np.eye(3), (count, 1, 1)),
        motion=np.zeros(count),
        truth=np.array([int(onset is not None and frame >= onset) for _, frame, onset in rows]),
        outputs=("hold", "slip"),
    )


def test_delays_are_counted_from_gross_slip() -> None:
    """Told two frames late, one early, and never; a slide that never slips is none."""
    found = slides({"late": 10, "early": 12, "missed": 9, "holds": None})
    first = {"late": 12, "early": 11, "missed": 99, "holds": 99}

    def told(asked: Examples) -> np.ndarray:
        named = [name.split(":") for name in asked.names]
        return np.array([int(int(frame) >= first[case]) for case, frame in named])

    network: Any = SimpleNamespace(told=told)
    delays = slip_delays(network, found, 0.1)
    assert (delays["slides"], delays["missed"], delays["false_alarms"]) == (3, 1, 1)
    assert sorted(delays["frames"]) == [-1, 2] and delays["median_frames"] == 0.5


def test_what_tells_the_time_tells_nothing_within_a_frame() -> None:
    """Slides that slip from frames 8 and 12 on: frames 8 to 11 have both, and time tells a half."""
    found = slides({"soon": 8, "late": 12})
    clock: Any = SimpleNamespace(
        told=lambda asked: np.array([int(int(n.split(":")[1]) >= 10) for n in asked.names])
    )
    sees: Any = SimpleNamespace(told=lambda asked: asked.truth)
    assert (within_frames(clock, found), within_frames(sees, found)) == (0.5, 1.0)
    assert within_frames(sees, slides({"soon": 8, "too": 8})) == 0.5


@pytest.mark.parametrize(
    ("onsets", "low", "high"), [([10] * 10, 1.0, 1.0), ([8, 16] * 5, 0.6, 0.95)]
)
def test_the_time_alone_tells_slip_that_always_comes_at_once(
    onsets: list[int], low: float, high: float
) -> None:
    """Where all slides slip in one frame it tells all; where they differ, less."""
    found = slides({f"s{k}": onset for k, onset in enumerate(onsets)})
    parts = [by_place(found.places, seed) for seed in range(3)]
    assert low <= told_by_frame(found, parts) <= high
