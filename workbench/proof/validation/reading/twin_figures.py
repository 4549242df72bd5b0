"""Readings of a twin, before and after its calibration: what a designer has who casts the sensor.

The twin is made, calibrated by its ball photographs, and its presses are read twice: by the design
as it was drawn, and by the calibrated one.

    python -m workbench.proof.validation.reading.twin_figures FOLDER --jobs 8

makes the record. Everything is kept in FOLDER, so that a run that was stopped goes on where it was;
a calibration by other code is made anew. `--refine powers` stops a calibration after the powers.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from workbench.calibration.calibrate import calibrate
from workbench.calibration.outputs import DESIGN as CALIBRATED
from workbench.calibration.outputs import write_calibration
from workbench.calibration.photo_set import read_photo_set
from workbench.core.base.monitor import Monitor
from workbench.core.design.design import SensorDesign
from workbench.photographs.photo_files import decoded
from workbench.pipeline.devices import chosen_device
from workbench.pipeline.store import Store
from workbench.project.named_designs import load_design
from workbench.project.project import Project
from workbench.reading.design_reader import open_reader
from workbench.reading.read_photo import read_photo
from workbench.system.record import Record
from workbench.system.terminal import Progress
from workbench.system.whole_files import write_atomically
from workbench.twin.cases import Kind
from workbench.twin.make import make_twin, photo_names
from workbench.twin.scoring import ReadingScore, Scorer, mean_score
from workbench.twin.truth import FOLDER, read_truth
from workbench.twin.twin_folder import DESIGN, FOLDERS
from workbench.twin.twin_plan import Solver, TwinPlan

DESIGNS = ("pad", "geltip")
WIDTH_PX = 320
UNCALIBRATED, CALIBRATION = "uncalibrated", "calibrated"
MADE_BY = "made_by.json"
"""In the folder of a calibration: the code that made it, and how."""

RECORD = Record(
    path=Path(__file__).with_name("twin_figures.json"),
    command="python -m workbench.proof.validation.reading.twin_figures FOLDER --jobs 8",
    sources=(
        "workbench.proof.validation.reading.twin_figures",
        "sim.reading",
        "sim.optics.field.models",
    ),
    apart=(
        "sim.contact",
        "sim.fem",
        "sim.forces",
        "workbench.learning.making",
        "workbench.learning.training",
        "workbench.system",
        "workbench.view",
        "workbench.report",
        "workbench.proof.row",
    ),
)
"""Presses are data: solvers of another day do not make it stale; another light, calibration or
reader does."""


@dataclass(frozen=True, kw_only=True, slots=True)
class TwinRun:
    """One design's twin."""

    name: str
    folder: Path
    plan: TwinPlan
    store: Store
    refining: str
    """How far the calibration goes: `all` or `powers`."""
    monitor: Progress

    def figures(self) -> dict[str, Any]:
        """Scores of its presses, read by the design and by the calibrated one.

        Raises:
            WorkbenchError: From what makes, calibrates and reads.
        """
        design = load_design(self.name, project=Project(self.store.root.parent))
        made = make_twin(design, self.folder, self.plan, self.store, self._told("twin"))
        drawn = load_design(str(self.folder / DESIGN))
        found = {
            "plan": {
                "seed": self.plan.seed,
                "contact": self.plan.contact.value,
                "photons_millions": self.plan.photons(chosen_device()) // 1_000_000,
                "width_px": drawn.optics.camera.width_px,
                "calibration": made.photos[Kind.CALIBRATION],
                "presses": made.photos[Kind.PRESS],
                "failed": len(made.failed),
                "refine": self.refining,
            },
            UNCALIBRATED: self.scored(drawn, UNCALIBRATED),
            CALIBRATION: self.scored(self.calibrated(drawn), CALIBRATION),
        }
        text = json.dumps(found, indent=1, allow_nan=False)
        write_atomically(self.folder / "scores.json", f"{text}\n".encode())
        return found

    def calibrated(self, design: SensorDesign) -> SensorDesign:
        """The design fitted to the twin's ball photographs, from the folder or fitted now."""
        out = self.folder / CALIBRATION
        made_by, now = out / MADE_BY, {"code": RECORD.code(), "refine": self.refining}
        if not made_by.exists() or json.loads(made_by.read_bytes()) != now:
            photos = read_photo_set(self.folder / FOLDERS[Kind.CALIBRATION])
            fitted = calibrate(
                design,
                photos,
                self.store,
                lights="auto",
                refining=self.refining,
                monitor=self._told("calibrate"),
            )
            write_calibration(out, fitted, photos.idle)
            write_atomically(made_by, json.dumps(now).encode())
        return load_design(str(out / CALIBRATED))

    def scored(self, design: SensorDesign, what: str) -> dict[str, float | None]:
        """Mean score of all presses by a design's reader, and of how many."""
        place = self.folder / FOLDERS[Kind.PRESS]
        told, scores = self._told(what), list[ReadingScore]()
        opened = open_reader(design, _photo(place / "idle.png"), self.store, monitor=told)
        scorer, names = Scorer(opened), list(photo_names(self.folder, Kind.PRESS))
        for number, name in enumerate(names):
            told(number / len(names), name)
            reading = read_photo(opened, name, _photo(place / f"{name}.png"))
            scores.append(scorer.score(reading, read_truth(self.folder / FOLDER / f"{name}.npz")))
        rows = [{"photo": each.photo, **each.figures} for each in scores]
        text = json.dumps(rows, indent=1, allow_nan=False)
        write_atomically(self.folder / f"{what}.json", f"{text}\n".encode())
        return {"count": float(len(scores)), **mean_score(scores).figures}

    def _told(self, what: str) -> Monitor:
        return lambda fraction, note="": self.monitor(f"{self.name} {what}", fraction, note)


def _photo(path: Path) -> np.ndarray:
    return decoded(path.name, path.read_bytes())


def main(words: Sequence[str]) -> int:
    """Make the record."""
    from workbench.pipeline.devices import open_device

    parser = argparse.ArgumentParser(description="readings of twins before and after calibration")
    parser.add_argument("folder", type=Path, help="keeps twins, calibrations and light")
    parser.add_argument("designs", nargs="*", default=list(DESIGNS))
    for name, usual in (("seed", 1), ("calibration", 20), ("presses", 140), ("photons", 0)):
        parser.add_argument(f"--{name}", type=int, default=usual)
    parser.add_argument("--width", type=int, default=WIDTH_PX)
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--refine", choices=("all", "powers"), default="all")
    parser.add_argument("--contact", choices=[each.value for each in Solver], default="fem")
    options = parser.parse_args(words)
    plan = TwinPlan(
        seed=options.seed,
        calibration=options.calibration,
        presses=options.presses,
        slides=0,
        contact=Solver(options.contact),
        photons_millions=options.photons,
        width_px=options.width,
        jobs=options.jobs,
    )
    open_device()
    store, progress = Project(options.folder / "project").store, Progress(as_json=True)
    runs = {
        name: TwinRun(
            name=name,
            folder=options.folder / name,
            plan=plan,
            store=store,
            refining=options.refine,
            monitor=progress,
        )
        for name in options.designs or DESIGNS
    }
    RECORD.make(lambda: {"designs": {name: run.figures() for name, run in runs.items()}})
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
