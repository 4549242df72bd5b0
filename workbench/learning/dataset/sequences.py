"""Sequences of frames for telling slip, as many with gross slip as without.

A case presses and then drags. Gross slip begins in the first frame in which `GROSS_SHARE` of the
contact's area slides. Each case that gets there gives two sequences of consecutive frames: one that
ends before that frame, and one that ends in it or later, each at a frame drawn at random; so the
two classes are balanced case by case, whatever the object, the place and the friction. A case that
never slips, or slips before a sequence is full, gives none.
The paper labels by the turn of the tangential force; its sequences have eight frames. Source:
SimTac, Supplementary, "Slip detection setup".
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import asdict, dataclass

import numpy as np

from sim.forces.slip import GROSS_SHARE
from workbench.learning.dataset.cases import Case
from workbench.learning.dataset.folder import DataSet
from workbench.system.whole_files import write_atomically

SEQUENCES = "sequences.jsonl"
FRAMES = 8
"""Frames of a sequence. Source: SimTac."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Sequence:
    """Consecutive frames of a case."""

    case: str
    first: int
    """Its first frame, from 0."""
    frames: int
    slip: bool
    """Whether all of the contact slides in its last frame, or did before."""
    split: str
    """That of the case: both sequences of one are in the same."""


def write_sequences(data: DataSet, count: int) -> int:
    """Write the first so many sequences of a data set; returns how many there are."""
    found = [sequence for pair in _pairs(data, count // 2) for sequence in pair]
    text = "".join(json.dumps(asdict(sequence)) + "\n" for sequence in found)
    write_atomically(data.folder / SEQUENCES, text.encode())
    return len(found)


def _pairs(data: DataSet, most: int) -> Iterator[tuple[Sequence, Sequence]]:
    taken = 0
    for number, case in enumerate(data.cases()):
        if taken == most:
            return
        onset = gross_slip(data, case)
        if onset is not None and onset >= FRAMES:
            taken += 1
            rng = np.random.default_rng((data.manifest["recipe"]["seed"], number, 2))
            before, after = rng.integers(FRAMES - 1, onset), rng.integers(onset, case.frames)
            yield _ending(case, int(before), slip=False), _ending(case, int(after), slip=True)


def _ending(case: Case, last: int, *, slip: bool) -> Sequence:
    first = last + 1 - FRAMES
    return Sequence(case=case.id, first=first, frames=FRAMES, slip=slip, split=case.split.value)


def gross_slip(data: DataSet, case: Case) -> int | None:
    """First frame of gross slip, from 0; None where there is none, or frames are missing."""
    if len(data.frames(case)) < case.frames:
        return None
    for frame in range(case.press_frames, case.frames):
        sample = data.sample(case, frame)
        solved = sample.fem or sample.mpm
        if solved is not None and solved.sliding_share >= GROSS_SHARE:
            return frame
    return None
