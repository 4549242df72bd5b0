"""The curves of a training as files: a row per epoch, in JSON lines, CSV and a chart."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from sim.forces.network.spec import Target
from workbench.learning.training.chart import Series, chart
from workbench.system.whole_files import write_atomically

JSONL, CSV, PNG = "curves.jsonl", "curves.csv", "curves.png"
COLUMNS = (
    "epoch",
    "rate",
    "train_loss",
    "train_mae",
    "validation_loss",
    "validation_mae",
    "zero_mae",
    "mpm_mae",
    "seconds",
)
"""Of a row. Losses are over that of zero output; errors are in the target's unit, `zero_mae` and
`mpm_mae` those of saying zero and of the contact solver on the same validation samples."""


def write_curves(folder: Path, rows: Sequence[Mapping[str, Any]]) -> None:
    """Write all rows as JSON lines and as CSV.

    Raises:
        StoreError: If the disk is full or read-only.
    """
    lines = "".join(json.dumps(row) + "\n" for row in rows)
    write_atomically(folder / JSONL, lines.encode())
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(COLUMNS)
    writer.writerows([row[name] for name in COLUMNS] for row in rows)
    write_atomically(folder / CSV, text.getvalue().encode())


def write_chart(folder: Path, rows: Sequence[Mapping[str, Any]], target: Target) -> bool:
    """Draw the errors by epoch; False where there is nothing to draw, or nothing to draw with.

    A machine that is lent for training may lack OpenCV: the same command draws it later.

    Raises:
        StoreError: If the disk is full or read-only.
    """
    series = [
        Series.of("training", rows, "epoch", "train_mae"),
        Series.of("validation", rows, "epoch", "validation_mae"),
        Series.of("zero predictor", rows, "epoch", "zero_mae", reference=True),
        Series.of("contact solver", rows, "epoch", "mpm_mae", reference=True),
    ]
    series = [each for each in series if each.points]
    if not series:
        return False
    title = f"Mean absolute error of {target} [{target.unit}] by epoch"
    try:
        from workbench.report.image_files import png_bytes

        drawn_png = png_bytes(chart(series, title))
    except ImportError:
        return False
    write_atomically(folder / PNG, drawn_png)
    return True
