"""Readings of a twin, before and after its calibration: what a designer has who casts the sensor.

The twin is made, calibrated by its ball photographs, and its presses are read four times: by the
design as it was drawn, by the reader that was learned for that, and by the calibrated design, with
the places that the stage knows and without them. Then the same of the twin in another reality: a
gel by Gent's law, photographed by Mitsuba.

    python -m workbench.proof.validation.reading.twin_figures FOLDER --jobs 8

makes the record. Everything is kept in FOLDER, so that a run that was stopped goes on where it was;
a calibration by other code is made anew. `--refine powers` stops a calibration after the powers;
`--other 0` leaves the other reality out, where Mitsuba is not installed.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from workbench.calibration.calibrate import calibrate
from workbench.calibration.outputs import DESIGN as CALIBRATED
from workbench.calibration.outputs import write_calibration
from workbench.calibration.seen.photo_set import read_photo_set
from workbench.calibration.stored import stored
from workbench.core.base.errors import DesignError
from workbench.core.base.monitor import Monitor
from workbench.core.design.design import SensorDesign
from workbench.core.press.press_case import PressCase
from workbench.photographs.photo_files import decoded
from workbench.pipeline.devices import chosen_device, torch_device
from workbench.project.named_designs import load_design
from workbench.project.project import Project
from workbench.reading.design_reader import open_reader
from workbench.reading.find_reader import find_reader
from workbench.reading.learned_reader import LearnedReader, LearnedReading
from workbench.reading.read_photo import Reading, read_photo
from workbench.system.record import Record
from workbench.system.terminal import Progress
from workbench.system.whole_files import write_atomically
from workbench.twin.cases import Kind
from workbench.twin.make import make_twin, photo_names
from workbench.twin.scoring import ReadingScore, Scorer, mean_score
from workbench.twin.truth import FOLDER, read_truth
from workbench.twin.twin_folder import DESIGN, FOLDERS
from workbench.twin.twin_plan import Light, Solver, TwinPlan

DESIGNS = ("pad", "geltip")
WIDTH_PX = 320
OBJECT_MM = 7.5
"""The middle of what tasks of the paper's size press: their twins are the same presses."""
OTHER = "other"
"""Behind the name of a design's twin in the other reality."""
OTHER_PRESSES = 50
UNCALIBRATED, CALIBRATION, LEARNED = "uncalibrated", "calibrated", "learned"
UNPLACED = "calibrated_unplaced"
"""Calibrated by one who has no stage, or does not know where it was."""
MADE_BY = "made_by.json"
"""In the folder of a calibration: the code that made it, and how."""

Read = Callable[[str, np.ndarray], Reading | LearnedReading]
"""A photograph's name and image to what is read of it."""

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

    key: str
    """Of its figures."""
    name: str
    """Of the design."""
    folder: Path
    plan: TwinPlan
    project: Project
    refining: str
    """How far the calibration goes: `all` or `powers`."""
    monitor: Progress

    def figures(self) -> dict[str, Any]:
        """Scores of its presses, read by the design and by the calibrated one.

        Raises:
            WorkbenchError: From what makes, calibrates and reads.
        """
        design, store = load_design(self.name, project=self.project), self.project.store
        made = make_twin(design, self.folder, self.plan, store, self._told("twin"))
        drawn = load_design(str(self.folder / DESIGN))
        found = {
            "plan": {
                "seed": self.plan.seed,
                "contact": self.plan.contact.value,
                "light": self.plan.light.value,
                "photons_millions": self.plan.photons(chosen_device()) // 1_000_000,
                "width_px": drawn.optics.camera.width_px,
                "calibration": made.photos[Kind.CALIBRATION],
                "presses": made.photos[Kind.PRESS],
                "failed": len(made.failed),
                "refine": self.refining,
            },
            UNCALIBRATED: self.scored(drawn, UNCALIBRATED),
            **self.learned(drawn),
            UNPLACED: self.scored(self.calibrated(drawn, UNPLACED), UNPLACED),
            CALIBRATION: self.scored(self.calibrated(drawn, CALIBRATION), CALIBRATION),
        }
        text = json.dumps(found, indent=1, allow_nan=False)
        write_atomically(self.folder / "scores.json", f"{text}\n".encode())
        return found

    def calibrated(self, design: SensorDesign, what: str) -> SensorDesign:
        """The design fitted to the twin's ball photographs, from the folder or fitted now."""
        out = self.folder / what
        made_by, now = out / MADE_BY, {"code": RECORD.code(), "refine": self.refining}
        if not made_by.exists() or json.loads(made_by.read_bytes()) != now:
            photos = read_photo_set(self.folder / FOLDERS[Kind.CALIBRATION])
            if what == UNPLACED:
                bare = tuple(replace(each, place_mm=None) for each in photos.photos)
                photos = replace(photos, photos=bare)
            fitted = calibrate(
                design,
                photos,
                self.project.store,
                lights="auto",
                refining=self.refining,
                monitor=self._told(what),
            )
            write_calibration(out, fitted, photos.idle)
            write_atomically(made_by, json.dumps(now).encode())
        return load_design(str(out / CALIBRATED))

    def learned(self, design: SensorDesign) -> dict[str, Any]:
        """Mean score of all presses by the reader learned for a design; empty where none was."""
        try:
            weights = find_reader(design, self.project, None)
        except DesignError:
            return {}
        idle, told = self._idle(), self._told(LEARNED)
        mesh = stored(design, PressCase(), "mesh", self.project.store, told)
        reader = LearnedReader(weights, design.optics.camera, mesh, idle, torch_device())
        return {LEARNED: self._mean(design, reader.read, LEARNED)}

    def scored(self, design: SensorDesign, what: str) -> dict[str, float | None]:
        """Mean score of all presses by a design's reader, and of how many."""
        store, told = self.project.store, self._told(what)
        opened = open_reader(design, self._idle(), store, monitor=told)
        return self._mean(design, lambda name, photo: read_photo(opened, name, photo), what)

    def _mean(self, design: SensorDesign, read: Read, what: str) -> dict[str, float | None]:
        """Mean score of what a reader reads, each beside the skin that the design's reader sees."""
        told, rows = self._told(what), list[dict[str, Any]]()
        scorer = Scorer(open_reader(design, self._idle(), self.project.store, monitor=told))
        names, scores = list(photo_names(self.folder, Kind.PRESS)), list[ReadingScore]()
        for number, name in enumerate(names):
            told(number / len(names), name)
            reading = read(name, _photo(self._presses / f"{name}.png"))
            scores.append(scorer.score(reading, read_truth(self.folder / FOLDER / f"{name}.npz")))
            rows.append({"photo": name, **scores[-1].figures})
        text = json.dumps(rows, indent=1, allow_nan=False)
        write_atomically(self.folder / f"{what}.json", f"{text}\n".encode())
        return {"count": float(len(scores)), **mean_score(scores).figures}

    @property
    def _presses(self) -> Path:
        return self.folder / FOLDERS[Kind.PRESS]

    def _idle(self) -> np.ndarray:
        return _photo(self._presses / "idle.png")

    def _told(self, what: str) -> Monitor:
        return lambda fraction, note="": self.monitor(f"{self.key} {what}", fraction, note)


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
    parser.add_argument("--other", type=int, default=OTHER_PRESSES, help="presses by Mitsuba")
    parser.add_argument("--width", type=int, default=WIDTH_PX)
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--refine", choices=("all", "powers"), default="all")
    parser.add_argument("--contact", choices=("fem", "mpm"), default="fem")
    options = parser.parse_args(words)
    open_device()
    runs = {run.key: run for run in _runs(options)}
    RECORD.make(lambda: {"designs": {key: run.figures() for key, run in runs.items()}})
    return 0


def _runs(options: argparse.Namespace) -> Iterator[TwinRun]:
    """Each design's twin, and then each in the other reality."""
    plan = TwinPlan(
        seed=options.seed,
        calibration=options.calibration,
        presses=options.presses,
        slides=0,
        contact=Solver(options.contact),
        photons_millions=options.photons,
        width_px=options.width,
        object_mm=OBJECT_MM,
        jobs=options.jobs,
    )
    # By the contact solver, which knows one law only, the other light is all that is other.
    law = Solver.GENT if plan.contact is Solver.FEM else plan.contact
    other = replace(plan, presses=options.other, contact=law, light=Light.MITSUBA)
    project, progress = Project(options.folder / "project"), Progress(as_json=True)
    for each in (plan, other):
        for name in (options.designs or DESIGNS) if each.presses else ():
            key = name if each is plan else f"{name}-{OTHER}"
            yield TwinRun(
                key=key,
                name=name,
                folder=options.folder / key,
                plan=each,
                project=project,
                refining=options.refine,
                monitor=progress,
            )


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
