"""How late slip is told: windows that end at each frame of a slide, one after the other.

A slide is told to slip in the first frame in which the window that ends there is. The delay is
counted from the first frame in which 95 % of the contact slides; a negative one is a false alarm.
"""

from __future__ import annotations

from collections.abc import Set
from typing import Any

import numpy as np

from sim.forces.slip import GROSS_SHARE
from workbench.learning.dataset.cases import Case
from workbench.learning.dataset.folder import DataSet
from workbench.learning.dataset.photo_export import windows
from workbench.learning.dataset.sequences import FRAMES
from workbench.tasks.examples import SLIP_NAMES, Examples
from workbench.tasks.rendered import AtRest, Shown
from workbench.tasks.seen_images import View, change
from workbench.tasks.trained import Trained


def slip_delays(
    data: DataSet,
    images: tuple[Shown, AtRest],
    network: Trained,
    places: Set[str],
    view: View,
) -> dict[str, Any]:
    """Delays of the slides at some places.

    Args:
        data: With sequences.
        images: Of a sample, and at rest.
        network: That did not learn from these places.
        places: Names of places on the skin.
        view: Says which part of an image is seen.
    """
    cases = {case.id: case for case, _ in windows(data) if case.position.name in places}
    delays: list[int] = []
    missed = 0
    for case in cases.values():
        found = _delay(data, images, network, case, view)
        if found is None:
            missed += 1
        else:
            delays.append(found)
    return {
        "slides": len(cases),
        "missed": missed,
        "false_alarms": sum(delay < 0 for delay in delays),
        "frames": delays,
        "median_frames": float(np.median(delays)) if delays else None,
        "frame_mm": data.manifest["recipe"]["shear_step_mm"],
    }


def _delay(
    data: DataSet, images: tuple[Shown, AtRest], network: Trained, case: Case, view: View
) -> int | None:
    """Frames from gross slip to the first window that tells it; None where none does."""
    shown, at_rest = images
    samples = [data.sample(case, frame) for frame in range(case.frames)]
    own = [shown(case, sample) for sample in samples]
    ends = range(FRAMES, case.frames + 1)
    rest = at_rest(case)
    changes = [change(own[end - FRAMES : end], rest, view) for end in ends]
    told = network.told(
        Examples(
            names=tuple(str(end) for end in ends),
            places=np.full(len(changes), case.position.name),
            inputs=np.stack([each.grey for each in changes]),
            at=np.array([each.at for each in changes], np.float32),
            feet_mm=np.array([each.foot_mm for each in changes]),
            axes=np.array([each.axes for each in changes]),
            motion=np.zeros(len(changes)),
            truth=np.zeros(len(changes), np.int64),
            outputs=SLIP_NAMES,
        )
    )
    slides = np.flatnonzero(told == 1)
    if not len(slides):
        return None
    return ends[int(slides[0])] - 1 - _onset(case, samples)


def _onset(case: Case, samples: list[Any]) -> int:
    """First frame of gross slip; every case of a sequence has one."""
    return next(
        frame
        for frame in range(case.press_frames, case.frames)
        if (samples[frame].fem or samples[frame].mpm).sliding_share >= GROSS_SHARE
    )
