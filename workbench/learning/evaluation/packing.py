"""Writes held-out sets: which samples are kept, and how their fields become whole numbers.

Kept are the last frame of the press of each held-out case, the one half as deep, and the last of
its shear; where that is too large for the file, the cases are thinned evenly. The training and
validation cases of the set are never in it.
"""

from __future__ import annotations

import io
import json
from collections.abc import Sequence
from typing import Any

import numpy as np

from workbench.core.base.errors import StoreError
from workbench.core.base.monitor import Monitor, silent
from workbench.core.base.version import VERSION
from workbench.learning.dataset.cases import Case, case_row
from workbench.learning.dataset.folder import mesh_key
from workbench.learning.evaluation.held_out import FORMAT, PARTS, SOLVERS, STEPS, content_digest
from workbench.learning.evaluation.scoring import both
from workbench.learning.evaluation.sources import HELD_OUT, Source, expect_held_out, young_MPa

MOST_BYTES = 6_000_000
"""Of a file that ships."""
THINNER = 0.9
"""Share of the fitting number of cases that is tried next."""


def made_from(
    source: Source, *, most_bytes: int = MOST_BYTES, name: str, monitor: Monitor = silent
) -> bytes:
    """The file of a held-out set, no larger than asked.

    Raises:
        DesignError: If nothing is held out.
        StoreError: If a sample is damaged or lacks a solver, or one case is too large already.
    """
    chosen = chosen_states(expect_held_out(source, name))
    cases = list(dict.fromkeys(case.id for case, _ in chosen))
    kept = len(cases)
    while True:
        picks = np.unique(np.linspace(0, len(cases) - 1, kept).astype(int))
        ids = {cases[pick] for pick in picks}
        content = _packed(source, [one for one in chosen if one[0].id in ids], monitor)
        if len(content) <= most_bytes:
            return content
        if kept == 1:
            raise StoreError(
                f"one case takes {len(content)} bytes, the limit is {most_bytes}",
                hint="allow a larger file",
                at="--most-mb",
            )
        kept = max(1, min(kept - 1, int(THINNER * kept * most_bytes / len(content))))


def chosen_states(states: Sequence[tuple[Case, int]]) -> list[tuple[Case, int]]:
    """Of each case the last frame of its press, the one half as deep, and the last of its shear."""
    return [
        (case, frame)
        for case, frame in states
        if frame in (case.press_frames // 2 - 1, case.press_frames - 1, case.frames - 1)
    ]


def _packed(source: Source, chosen: Sequence[tuple[Case, int]], monitor: Monitor) -> bytes:
    rows, columns = [], {part: _Column() for part in PARTS}
    for number, (case, frame) in enumerate(chosen):
        monitor(number / len(chosen), case.id)
        sample = source.sample(case, frame)
        solved = both(sample)
        largest: dict[str, float] = {}
        for part, column in columns.items():
            tops = column.add([getattr(one, part) for one in solved])
            largest |= {f"{name}.{part}": top for name, top in zip(SOLVERS, tops, strict=True)}
        placed = ("pose", "target_mm", "normal", "tangent_u")
        rows.append(
            {
                **{name: getattr(sample, name).tolist() for name in placed},
                "case": case.id,
                "frame": frame,
                "largest": largest,
            }
        )
    arrays: dict[str, np.ndarray] = {
        "points_mm": np.asarray(source.skin.points_mm),
        "faces": np.asarray(source.skin.faces),
        "areas_mm2": np.asarray(source.skin.areas_mm2),
    }
    for part, column in columns.items():
        arrays |= {f"{part}.{name}": values for name, values in column.arrays().items()}
    return _file(source, chosen, rows, arrays)


class _Column:
    """One field of all samples and both solvers, as whole numbers."""

    def __init__(self) -> None:
        self.counts: list[int] = []
        self.steps: list[np.ndarray] = []
        self.values: list[np.ndarray] = []

    def add(self, fields: Sequence[np.ndarray]) -> list[float]:
        """Add a sample; returns the largest number of each solver's field."""
        tops = [float(np.abs(field).max(initial=0.0)) for field in fields]
        pairs = zip(fields, tops, strict=True)
        whole = [np.rint(field * (STEPS / (top or 1.0))) for field, top in pairs]
        values = np.stack(whole, axis=1).astype(np.int16)
        index = np.flatnonzero(values.any(axis=(1, 2)))
        self.counts.append(len(index))
        self.steps.append(np.diff(index, prepend=0))
        self.values.append(values[index])
        return tops

    def arrays(self) -> dict[str, np.ndarray]:
        """What the file holds of it."""
        shorts = np.concatenate(self.values).view(np.uint16)
        return {
            "counts": np.array(self.counts, np.int32),
            "steps": np.concatenate(self.steps).astype(np.int32),
            "bytes": np.stack([shorts >> 8, shorts & 0xFF]).astype(np.uint8),
        }


def _file(
    source: Source,
    chosen: Sequence[tuple[Case, int]],
    rows: list[dict[str, Any]],
    arrays: dict[str, np.ndarray],
) -> bytes:
    head: dict[str, Any] = {
        "format": FORMAT,
        "program": VERSION,
        "key": source.key,
        "recipe": source.manifest["recipe"],
        "mesh": mesh_key(source.skin),
        "young_MPa": young_MPa(source),
        "splits": [split.value for split in HELD_OUT],
        "cases": list({case.id: case_row(case) for case, _ in chosen}.values()),
        "samples": rows,
    }
    head["content"] = content_digest(head, arrays)
    buffer = io.BytesIO()
    encoded = np.frombuffer(json.dumps(head).encode(), np.uint8)
    np.savez_compressed(buffer, allow_pickle=False, head=encoded, **arrays)
    return buffer.getvalue()
