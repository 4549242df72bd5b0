"""Designs spread over a box by Sobol's sequence, and what came of each, as lines of a file.

A line stands for one design that has ended, so what is killed loses only the design that it was at;
of a line that was being written then, the torn end is cut off before more are added.
"""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from workbench.core.base.errors import DesignError, StoreError
from workbench.search.judged import Judged, from_journal
from workbench.search.problem import Value, Vary

BASE = -1
"""Number of the base, beside the designs that vary."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Sample:
    """A design that was evaluated."""

    number: int
    """In Sobol's sequence; `BASE` of the base."""
    values: Mapping[str, Value]
    """Of the varied fields, by path."""
    judged: Judged
    stage_s: Mapping[str, float]
    """Time spent in each stage, as its monitor was told [s]."""


def sobol_values(vary: Sequence[Vary], count: int, *, seed: int = 1) -> list[dict[str, Value]]:
    """The first designs of a scrambled Sobol sequence over the ranges and choices.

    Args:
        vary: The fields; whole numbers and choices have equal parts of their axis.
        count: How many designs.
        seed: Of the scrambling.
    """
    from scipy.stats.qmc import Sobol

    sequence = Sobol(len(vary), scramble=True, rng=np.random.default_rng(seed))
    unit = sequence.random_base2(max(count - 1, 1).bit_length())[:count]
    return [values_at(vary, row) for row in unit]


def values_at(vary: Sequence[Vary], unit: np.ndarray) -> dict[str, Value]:
    """Values at a point of the unit cube, shape (D,), rounded as proposals are."""
    return {each.path: _value(each, float(x)) for each, x in zip(vary, unit, strict=True)}


def _value(vary: Vary, x: float) -> Value:
    if vary.choices:
        return vary.choices[min(int(x * len(vary.choices)), len(vary.choices) - 1)]
    if vary.whole:
        low, high = round(vary.low), round(vary.high)
        return min(low + int(x * (high - low + 1)), high)
    if vary.log:
        return vary.rounded(vary.low * (vary.high / vary.low) ** x)
    return vary.rounded(vary.low + x * (vary.high - vary.low))


def write_sample(path: Path, sample: Sample, of: str) -> None:
    """Add a line, in one write, so that several processes may.

    Args:
        path: The file.
        sample: What came of a design.
        of: Digest of the problem, which all lines share.
    """
    table = {
        "number": sample.number,
        "of": of,
        "values": dict(sample.values),
        "judged": sample.judged.table,
        "stage_s": {name: round(spent, 3) for name, spent in sample.stage_s.items()},
    }
    line = f"{json.dumps(table, allow_nan=False)}\n".encode()
    descriptor = os.open(path, os.O_WRONLY | os.O_APPEND | os.O_CREAT, 0o644)
    try:
        os.write(descriptor, line)
    finally:
        os.close(descriptor)


def read_samples(path: Path, of: str) -> dict[int, Sample]:
    """What is there, by number; a torn last line is left out, no file is nothing.

    Args:
        path: The file.
        of: Digest of the problem.

    Raises:
        DesignError: If the file is of another problem.
        StoreError: If a whole line cannot be read.
    """
    if not path.exists():
        return {}
    lines = _whole(path.read_bytes()).splitlines()
    return {one.number: one for one in _parsed(lines, path, of)}


def _parsed(lines: Iterable[bytes], path: Path, of: str) -> Iterable[Sample]:
    for place, line in enumerate(lines, start=1):
        try:
            table: dict[str, Any] = json.loads(line)
            if table["of"] != of:
                raise DesignError(
                    f"{path} holds designs of another problem",
                    hint="name another folder, or remove the file",
                    at=str(path),
                )
            yield Sample(
                number=table["number"],
                values=table["values"],
                judged=from_journal(table["judged"]),
                stage_s=table["stage_s"],
            )
        except (ValueError, KeyError, TypeError) as error:
            raise StoreError(
                f"line {place} of {path} cannot be read: {error}", hint="remove it", at=str(path)
            ) from error


def mend(path: Path) -> None:
    """Cut off what a killed writer left of a line; nobody else may write meanwhile."""
    if not path.exists():
        return
    content = path.read_bytes()
    whole = _whole(content)
    if len(whole) < len(content):
        os.truncate(path, len(whole))


def _whole(content: bytes) -> bytes:
    return content[: content.rfind(b"\n") + 1]
