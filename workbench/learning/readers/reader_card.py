"""The data card of a learned reader, and its curves, as files beside it."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from sim.reading.network.reader_file import SUFFIX
from workbench.core.base.version import VERSION
from workbench.learning.dataset.folder import DataSet
from workbench.learning.readers.making import JUDGED, PRESSES
from workbench.learning.readers.view_set import ViewSet
from workbench.learning.training.chart import Series, chart
from workbench.report.image_files import png_bytes
from workbench.system.whole_files import write_atomically

Row = dict[str, Any]


def card_of(
    learned: ViewSet, folder: Path, rows: Sequence[Row], *, device: str, seed: int
) -> dict[str, Any]:
    """What a reader was made of, and how."""
    presses, judged = DataSet.open(folder / PRESSES), DataSet.open(folder / JUDGED)
    recipe = presses.manifest["recipe"]
    return {
        "program": VERSION,
        "data": {
            "presses": presses.counts()["cases_done"],
            "presses_that_judge": judged.counts()["cases_done"],
            "keys": [presses.key, judged.key],
            "views": len(learned),
            "views_of_presses": sum(view.solved for view in learned.views),
            "built_sensors": len({view.look for view in learned.views}),
            "objects": recipe["indenters"],
            "vary": recipe["vary"],
            "depth_mm": recipe["depth_mm"],
            "shear_mm": recipe["shear_mm"],
        },
        "training": {
            "device": device,
            "seed": seed,
            "minutes": rows[-1]["minutes"] if rows else 0.0,
            "epochs": rows[-1]["epochs"] if rows else 0.0,
        },
    }


def write_beside(out: Path, card: dict[str, Any], rows: Sequence[Row]) -> None:
    """Write `NAME-card.json`, `NAME-curves.csv` and `NAME-curves.png`.

    Raises:
        StoreError: If the disk is full or read-only.
    """
    stem = out.name.removesuffix(SUFFIX)
    text = json.dumps(card, indent=1, allow_nan=False) + "\n"
    write_atomically(out.with_name(f"{stem}-card.json"), text.encode())
    if not rows:
        return
    table = io.StringIO()
    writer = csv.DictWriter(table, list(rows[0]), lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    write_atomically(out.with_name(f"{stem}-curves.csv"), table.getvalue().encode())
    series = [
        Series.of("validation", rows, "minutes", "validation_mae_mm"),
        Series.of("zero depth", rows, "minutes", "zero_mae_mm", reference=True),
    ]
    series = [each for each in series if each.points]
    if series:
        drawn = chart(series, "Mean error of depth [mm] over moved skin by minutes")
        write_atomically(out.with_name(f"{stem}-curves.png"), png_bytes(drawn))
