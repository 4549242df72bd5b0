"""How late slip is told, and how well it is told from the time alone.

A slide is told to slip in the first frame in which the window that ends there is. The delay is
counted from the first window at whose end 95 % of the contact slides; a negative one is a false
alarm. Where windows are left out, it is known to so many frames.

In renders every slide is pressed and dragged in the same steps, so that a window slips the more
likely the later it is. What a threshold on the number of its last frame tells stands beside what
the network does, and so does what the network tells among windows that end in the same frame,
where time says nothing: there chance is a half.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from workbench.tasks.examples import Examples
from workbench.tasks.lessons import Lessons
from workbench.tasks.outcome import Tested, Trial
from workbench.tasks.scores import balanced_accuracy, best_threshold
from workbench.tasks.splits import Parts
from workbench.tasks.trained import Trained


def tell_slides(
    lessons: Lessons,
    networks: Mapping[Trial, Sequence[Trained]],
    tests: Sequence[Tested],
    frame_mm: float,
) -> None:
    """Add to details what the time alone tells and what is told without it, and delays by place.

    Args:
        lessons: With all windows of all slides.
        networks: Of all seeds, by test.
        tests: On renders, the last of them by place.
        frame_mm: Way of the object from frame to frame [mm].
    """
    for test in tests:
        parts, learned = lessons.parts(test.test), networks[test.test]
        held_out = [lessons.found.only(each.test) for each in parts]
        test.details["told_by_frame_alone"] = told_by_frame(lessons.found, parts)
        test.details["told_within_frames"] = float(
            np.mean([within_frames(*each) for each in zip(learned, held_out, strict=True)])
        )
    left = lessons.found.only(lessons.parts(Trial.PLACE)[0].test)
    tests[-1].details["delay"] = slip_delays(networks[Trial.PLACE][0], left, frame_mm)


def slip_delays(network: Trained, held_out: Examples, frame_mm: float) -> dict[str, Any]:
    """Delays of slides, in frames.

    Args:
        network: That did not learn from these slides.
        held_out: All windows of some slides.
        frame_mm: Way of the object from frame to frame [mm].
    """
    told = network.told(held_out)
    case, frame = _case_and_frame(held_out)
    delays: list[int] = []
    missed = slides = 0
    for name in np.unique(case):
        own = case == name
        slips = frame[own & (held_out.truth == 1)]
        if not len(slips):
            continue
        slides += 1
        alarms = frame[own & (told == 1)]
        if len(alarms):
            delays.append(int(alarms.min() - slips.min()))
        else:
            missed += 1
    return {
        "slides": slides,
        "missed": missed,
        "false_alarms": sum(delay < 0 for delay in delays),
        "frames": delays,
        "median_frames": float(np.median(delays)) if delays else None,
        "frame_mm": frame_mm,
    }


def told_by_frame(found: Examples, parts: Sequence[Parts]) -> float:
    """Balanced accuracy of a threshold on the last frame's number, mean over the splits."""
    _, frame = _case_and_frame(found)
    scores = []
    for train, _, test in parts:
        at = best_threshold(frame[train].astype(np.float64), found.truth[train])
        scores.append(balanced_accuracy((frame[test] > at).astype(int), found.truth[test]))
    return float(np.mean(scores))


def within_frames(network: Trained, held_out: Examples) -> float:
    """Balanced accuracy among windows that end in the same frame, mean over such frames.

    Frames in which all windows slip, or none does, do not count; without any it is a half.
    """
    told = network.told(held_out)
    _, frame = _case_and_frame(held_out)
    scores = [
        balanced_accuracy(told[frame == each], held_out.truth[frame == each])
        for each in np.unique(frame)
        if len(np.unique(held_out.truth[frame == each])) > 1
    ]
    return float(np.mean(scores)) if scores else 0.5


def _case_and_frame(found: Examples) -> tuple[np.ndarray, np.ndarray]:
    """Case and number of the last frame of each window, of the names that renders have."""
    named = [name.rpartition(":") for name in found.names]
    return np.array([case for case, _, _ in named]), np.array([int(last) for _, _, last in named])
