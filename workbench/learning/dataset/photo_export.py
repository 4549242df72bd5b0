"""A data set as a folder of photographs with `labels.csv`: what a network of one's own can read.

Files are PNG images as the camera sees them. `idle.png` is the first built sensor at rest; lines of
the others name their own.
"""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from workbench.core.base.errors import DesignError
from workbench.core.base.monitor import Monitor
from workbench.learning.dataset.cases import Case
from workbench.learning.dataset.folder import MARKED, PLAIN, DataSet, background_name
from workbench.learning.dataset.json_lines import read_rows
from workbench.learning.dataset.photo_labels import (
    FRAME,
    IDLE,
    LABELS,
    OWN_IDLE,
    PHOTO,
    SEQUENCE,
    SLIP,
    labels_of,
    table_bytes,
)
from workbench.learning.dataset.sample import Sample
from workbench.learning.dataset.sequences import SEQUENCES
from workbench.system.whole_files import write_atomically

SPLIT = "split"
"""Column beside the labels: what the data set holds the case for."""


def export_images(data: DataSet, out: Path, monitor: Monitor, *, marked: bool = False) -> int:
    """Write every image of a data set with its labels; returns how many.

    Args:
        data: Made with images.
        out: An empty or new folder.
        monitor: Progress.
        marked: Images with markers instead of those without.

    Raises:
        DesignError: If the folder is not empty, or the data set has no images.
        StoreError: If a sample is damaged, or the folder cannot be written.
    """
    _begin(data, out, marked)
    rows = []
    cases = data.cases()
    for number, case in enumerate(cases):
        monitor(number / len(cases), case.id)
        for frame in data.frames(case):
            sample = data.sample(case, frame)
            name = f"{case.id}/{frame:03d}.png"
            write_atomically(out / name, _png(sample, marked))
            rows.append(_row(data, case, sample, name, marked))
    write_atomically(out / LABELS, table_bytes(rows))
    return len(rows)


def export_windows(data: DataSet, out: Path, monitor: Monitor) -> int:
    """Write the sequences of a data set, images with markers; returns how many.

    Args:
        data: Made with images and sequences, as the recipe `slip` is.
        out: An empty or new folder.
        monitor: Progress.

    Raises:
        DesignError: If the folder is not empty, or the data set lists no sequences.
        StoreError: If a sample is damaged, or the folder cannot be written.
    """
    _begin(data, out, True)
    listed = list(windows(data))
    if not listed:
        raise DesignError(
            f"{data.folder} lists no sequences",
            hint="make it by the recipe slip, or use --images",
            at="--windows",
        )
    rows = []
    for number, (case, window) in enumerate(listed):
        monitor(number / len(listed), case.id)
        sequence = f"{case.id}_{'slip' if window['slip'] else 'hold'}"
        for order in range(window["frames"]):
            sample = data.sample(case, window["first"] + order)
            name = f"{sequence}/{order:03d}.png"
            write_atomically(out / name, _png(sample, True))
            row = _row(data, case, sample, name, True)
            rows.append({**row, SEQUENCE: sequence, FRAME: order, SLIP: int(window["slip"])})
    write_atomically(out / LABELS, table_bytes(rows))
    return len(listed)


def windows(data: DataSet) -> Iterator[tuple[Case, dict[str, Any]]]:
    """The sequences that a data set lists, each with its case; none where it lists none."""
    cases = {case.id: case for case in data.cases()}
    for row in read_rows(data.folder / SEQUENCES):
        yield cases[row["case"]], row


def _begin(data: DataSet, out: Path, marked: bool) -> None:
    if out.exists() and (not out.is_dir() or any(out.iterdir())):
        raise DesignError(f"{out} is not empty", hint="name a new folder", at="--out")
    files = {_idle_name(case): _idle_png(data, case, marked) for case in data.cases()}
    if not all(files.values()):
        raise DesignError(
            f"{data.folder} holds no images", hint="make it without --no-images", at="DATA"
        )
    for name, content in {IDLE: next(iter(files.values())), **files}.items():
        write_atomically(out / name, content)
    count = Counter(case.split.value for case in data.cases())
    told = {"made_from": data.key, "recipe": data.manifest["recipe"], "cases": count}
    write_atomically(out / "made_from.json", json.dumps(told, indent=1).encode())


def _idle_name(case: Case) -> str:
    return "idle.png" if case.drawn.look is None else f"idle-{case.drawn.look:02d}.png"


def _idle_png(data: DataSet, case: Case, marked: bool) -> bytes:
    path = data.folder / background_name(MARKED if marked else PLAIN, case.drawn.look, ".png")
    return path.read_bytes() if path.exists() else b""


def _png(sample: Sample, marked: bool) -> bytes:
    return sample.png_markers if marked else sample.png


def _row(
    data: DataSet, case: Case, sample: Sample, name: str, marked: bool
) -> dict[str, str | float]:
    own = {} if case.drawn.look is None else {OWN_IDLE: _idle_name(case)}
    return {PHOTO: name, **own, **labels_of(case, sample, data.skin), SPLIT: case.split.value}
