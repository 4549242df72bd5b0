"""The folder of a twin: which one it is, its photo folders, their tables, and what failed.

`calibration`, `presses` and `slides` are photo folders of their own, each with its `idle.png`;
`truth` has what their photographs really show, `card.json` what is hidden.
"""

from __future__ import annotations

import csv
import dataclasses
import io
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from workbench.calibration.seen.photo_set import COLUMNS, IDLE, TABLE
from workbench.core.base.digest import digest
from workbench.core.base.errors import DesignError
from workbench.core.base.mapping import to_table
from workbench.core.design.design import SensorDesign
from workbench.project.design_toml import design_files, design_table, design_to_toml
from workbench.report.image_files import png_bytes
from workbench.system.whole_files import write_atomically
from workbench.twin.cases import Kind
from workbench.twin.draw import Twin, card
from workbench.twin.gent import LIMIT
from workbench.twin.stage import draw_stage
from workbench.twin.taking import LABELS
from workbench.twin.twin_plan import Light, TwinPlan

CARD, DESIGN, FAILED, LABEL_TABLE = "card.json", "design.toml", "failed.json", "labels.csv"
FOLDERS = {Kind.CALIBRATION: "calibration", Kind.PRESS: "presses", Kind.SLIDE: "slides"}
"""Of the photographs of each kind."""
COUNTED = ("calibration", "presses", "slides", "jobs")
"""Fields of a plan that change no photograph: a twin can be gone on with by others."""


@dataclass(frozen=True, kw_only=True, slots=True)
class TwinFolder:
    """Where a twin is kept."""

    path: Path

    def photos(self, kind: Kind) -> Path:
        """The folder of a kind's photographs."""
        return self.path / FOLDERS[kind]

    def failed(self) -> dict[str, str]:
        """Paths that could not be solved, by name, with the reason."""
        try:
            return json.loads((self.path / FAILED).read_bytes())
        except FileNotFoundError:
            return {}

    def write_failed(self, failed: Mapping[str, str]) -> None:
        """Keep them, so that they are not tried again."""
        write_atomically(self.path / FAILED, json.dumps(dict(failed), indent=1).encode())

    def write_photo(self, kind: Kind, name: str, image: np.ndarray) -> None:
        """Write a photograph as `NAME.png`."""
        write_atomically(self.photos(kind) / name, png_bytes(image))

    def write_table(self, kind: Kind, rows: Sequence[Mapping[str, str]]) -> None:
        """Write the table of a kind's photographs: `presses.csv` of balls, else `labels.csv`."""
        balls = kind is Kind.CALIBRATION
        name, columns = (TABLE, COLUMNS) if balls else (LABEL_TABLE, LABELS)
        write_atomically(self.photos(kind) / name, _csv_bytes(columns, rows))


def open_folder(path: Path, twin: Twin, design: SensorDesign, plan: TwinPlan) -> TwinFolder:
    """Begin a twin's folder, or go on with it.

    Args:
        path: Made where there is none.
        twin: What was built.
        design: What it was built from, with the images' size.
        plan: How it is photographed.

    Raises:
        DesignError: If another twin is there.
        StoreError: If it cannot be written.
    """
    held = {name: value for name, value in to_table(plan).items() if name not in COUNTED}
    if plan.light is Light.PHOTONS:
        # As it was before there was another light: twins of that time can be gone on with.
        del held["light"]
    key = digest({"design": design_table(design), "plan": held})
    folder = TwinFolder(path=path)
    try:
        before = json.loads((path / CARD).read_bytes())
    except FileNotFoundError:
        before = None
    except ValueError:
        before = {}
    if before is not None and before.get("key") != key:
        raise DesignError(
            f"{path} holds another twin",
            hint="name another folder, or give the design and the options that it was made with",
            at="--out",
        )
    told = {
        "key": key,
        "design": design.name,
        "plan": held,
        "hidden": {**card(twin, design), "stage": to_table(draw_stage(twin.seed))},
        "light": {
            "photons": "the tracer and the coating of the workbench",
            "mitsuba": "Mitsuba 3: flakes of aluminium in a matte binder, mirrors in the wall",
        }[plan.light.value],
        "truth": {
            "fem": "finite elements, converged",
            "gent": f"finite elements, converged, of a gel by Gent's law, Jm = {LIMIT:g}",
            "mpm": "the contact solver: quicker, and not the ground truth",
        }[plan.contact.value],
    }
    write_atomically(path / CARD, json.dumps(told, indent=1).encode())
    plain = dataclasses.replace(design, name=design.name)
    write_atomically(path / DESIGN, design_to_toml(plain).encode())
    for name, content in design_files(design).items():
        write_atomically(path / name, content)
    return folder


def idle_files(kinds: Sequence[Kind]) -> dict[str, Kind]:
    """The photographs at rest of some kinds, relative to a twin's folder."""
    return {f"{FOLDERS[kind]}/{IDLE}": kind for kind in kinds}


def _csv_bytes(columns: Sequence[str], rows: Sequence[Mapping[str, Any]]) -> bytes:
    text = io.StringIO()
    writer = csv.DictWriter(text, columns, restval="", lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return text.getvalue().encode()
