"""Readings of calibrated twins by the reader that was learned for the design as it was drawn.

The twins, and their calibrations, are those of `twin_figures`: each press is read by that reader
from the photograph as it is, and from the photograph relit as the design was drawn.

    python -m workbench.proof.validation.reading.relit_figures FOLDER

makes the record from a FOLDER that `twin_figures` has filled; a calibration by other code is made
anew. `--photons` says how many millions of photons a twin was photographed by whose card leaves
that to the device.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from workbench.core.base.mapping import from_table
from workbench.pipeline.devices import torch_device
from workbench.project.named_designs import load_design
from workbench.project.project import Project
from workbench.proof.validation.reading import twin_figures
from workbench.proof.validation.reading.twin_figures import (
    CALIBRATION,
    DESIGNS,
    LEARNED,
    TwinRun,
)
from workbench.reading.find_reader import find_reader
from workbench.reading.relit_reader import open_relit
from workbench.system.terminal import Progress
from workbench.twin.cases import Kind
from workbench.twin.make import photo_names
from workbench.twin.twin_folder import CARD, DESIGN
from workbench.twin.twin_plan import GPU_PHOTONS, TwinPlan

AS_IT_IS, RELIT = "as_it_is", "relit"
MEDIAN = "force_error_median"

RECORD = replace(
    twin_figures.RECORD,
    path=Path(__file__).with_name("relit_figures.json"),
    command="python -m workbench.proof.validation.reading.relit_figures FOLDER",
    sources=(
        "workbench.proof.validation.reading.relit_figures",
        "sim.reading",
        "sim.optics.field.models",
    ),
)
"""As that of `twin_figures`."""


class RelitRun(TwinRun):
    """One design's twin, which is there."""

    def figures(self) -> dict[str, Any]:
        """Mean scores of its presses by the learned reader, as they are and relit.

        Raises:
            WorkbenchError: From what calibrates and reads.
        """
        drawn = load_design(str(self.folder / DESIGN))
        built = self.calibrated(drawn, CALIBRATION)
        opened = open_relit(
            (built, drawn),
            find_reader(drawn, self.project, None),
            self._idle(),
            self.project.store,
            monitor=self._told(RELIT),
            device=torch_device(),
        )
        return {
            "plan": {
                "contact": self.plan.contact.value,
                "light": self.plan.light.value,
                "photons_millions": self.plan.photons_millions,
                "width_px": drawn.optics.camera.width_px,
                "calibration": len(list(photo_names(self.folder, Kind.CALIBRATION))),
                "presses": len(list(photo_names(self.folder, Kind.PRESS))),
                "refine": self.refining,
            },
            AS_IT_IS: self.learned(drawn)[LEARNED] | self._median(LEARNED),
            RELIT: self._mean(built, opened.read, RELIT) | self._median(RELIT),
        }

    def _median(self, what: str) -> dict[str, float]:
        """The median error of the force: the mean is of presses that are hardly felt."""
        rows = json.loads((self.folder / f"{what}.json").read_bytes())
        return {MEDIAN: float(np.median([row["force_error"] for row in rows]))}


def main(words: Sequence[str]) -> int:
    """Make the record."""
    from workbench.pipeline.devices import open_device

    parser = argparse.ArgumentParser(description="learned readings of calibrated twins")
    parser.add_argument("folder", type=Path, help="what `twin_figures` filled")
    parser.add_argument("designs", nargs="*", default=list(DESIGNS))
    parser.add_argument("--photons", type=int, default=GPU_PHOTONS)
    options = parser.parse_args(words)
    open_device()
    runs = {name: _run(options.folder, name, options.photons) for name in options.designs}
    RECORD.make(lambda: {"designs": {key: run.figures() for key, run in runs.items()}})
    return 0


def _run(folder: Path, name: str, photons_millions: int) -> RelitRun:
    """The twin of a design as its card tells it."""
    held = json.loads((folder / name / CARD).read_bytes())["plan"]
    plan = from_table(
        TwinPlan, held | {"photons_millions": held["photons_millions"] or photons_millions}
    )
    return RelitRun(
        key=name,
        name=name,
        folder=folder / name,
        plan=plan,
        project=Project(folder / "project"),
        refining="all",
        monitor=Progress(as_json=True),
    )


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
