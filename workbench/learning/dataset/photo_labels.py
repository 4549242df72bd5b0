"""What is known of a photograph of a touch, as a line of `labels.csv` in a folder of photographs.

A folder holds `idle.png`, the photographs and `labels.csv` with the column `photo` and any of:

- `idle`: another photograph at rest for this line;
- `object`: name of a class; `slip`: 0 or 1, of a sequence;
- `sequence`, `frame`: photographs that follow each other, and their order;
- `place`: name of the place on the skin; a split by place keeps all of its photographs together;
- `depth_mm`, `peak_MPa`, `force_x_N`, `force_y_N`, `force_z_N`: of the object on the skin, in the
  sensor frame; `pose_*`: numbers of any name, here where the object touches first.

The peak is the largest mean pressure on a disc of `DISC_MM` anywhere on the skin, what a gauge of
that size would read. Under an edge the pressure at a point is as sharp as the mesh: of a cube of
7.3 mm, .53 mm deep in the pad, the contact solver says .23 MPa at a vertex, finite elements .10;
on the disc both say .053.
"""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Iterable, Mapping

from sim.forces.peaks import DISC_MM
from workbench.learning.dataset.cases import Case
from workbench.learning.dataset.folder import SkinData
from workbench.learning.dataset.sample import Sample

LABELS, IDLE = "labels.csv", "idle.png"
PHOTO, OWN_IDLE, OBJECT, SLIP = "photo", "idle", "object", "slip"
SEQUENCE, FRAME, PLACE, DEPTH, PEAK = "sequence", "frame", "place", "depth_mm", "peak_MPa"
FORCE = tuple(f"force_{axis}_N" for axis in "xyz")
TARGET = tuple(f"pose_{axis}_mm" for axis in "xyz")
POSE = "pose_"
"""Beginning of columns of a pose."""
DISC_MM2 = math.pi * DISC_MM**2 / 4.0
Labels = Mapping[str, "str | float"]


def labels_of(case: Case, sample: Sample, skin: SkinData) -> dict[str, str | float]:
    """Labels of a sample, by column; forces of finite elements where it has them."""
    solved = sample.fem or sample.mpm
    assert solved is not None, "a sample holds at least one solver's"
    return {
        OBJECT: sample.indenter,
        PLACE: case.position.name,
        DEPTH: sample.depth_mm,
        PEAK: solved.peaks(skin).peak_disc_N / DISC_MM2,
        **dict(zip(FORCE, (-solved.reaction_N).tolist(), strict=True)),
        **dict(zip(TARGET, sample.target_mm.tolist(), strict=True)),
    }


def table_bytes(rows: Iterable[Labels]) -> bytes:
    """Lines as a CSV file, with the columns that any of them has."""
    rows = list(rows)
    columns = list(dict.fromkeys(name for row in rows for name in row))
    text = io.StringIO()
    writer = csv.DictWriter(text, columns, restval="", lineterminator="\n")
    writer.writeheader()
    writer.writerows(
        {name: f"{v:.6g}" if isinstance(v, float) else v for name, v in row.items()} for row in rows
    )
    return text.getvalue().encode()
