"""Train the reader of a design: its data, its network, its honest deviations, its file.

What is made on the way lies in a folder beside the file, `NAME-training`, so that what was stopped
goes on; it may be deleted afterwards. Beside the file lie the data card and the curves.
"""

from __future__ import annotations

import json
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from sim.reading.network.reader_file import ReaderFile, reader_bytes
from sim.reading.network.spec import Scales, spec_for
from workbench.calibration.stored import stored
from workbench.core.base.digest import digest
from workbench.core.base.errors import DesignError, StoreError
from workbench.core.base.monitor import Monitor, part
from workbench.core.design.design import SensorDesign
from workbench.core.press.press_case import PressCase
from workbench.learning.dataset.lock import held
from workbench.learning.readers.at_rest import rest_view
from workbench.learning.readers.beginning import training_folder
from workbench.learning.readers.learn import Row, learn
from workbench.learning.readers.lesson import Lesson
from workbench.learning.readers.making import Amount, Task, make_views
from workbench.learning.readers.reader_card import card_of, write_beside
from workbench.learning.readers.scoring import honest, judged, scores
from workbench.learning.readers.view_set import ViewSet, read_views
from workbench.pipeline.devices import torch_device
from workbench.planning.plan import StageMonitor, stage_monitor
from workbench.project.project import Project
from workbench.reading.reader_digest import reader_digest
from workbench.system.whole_files import write_atomically

AMOUNTS = {
    "cpu": Amount(cases=200, views=3000, looks=6),
    "cuda": Amount(cases=1600, views=24_000, looks=16),
}
"""What is made at most, by the device that trains."""
LEAST_LEARNING = 0.3
"""Share of the time that is left for learning, however long data took."""
MADE = "made.json"
JUDGED_VIEWS = 512
"""Views of each built sensor that judges, at most."""


@dataclass(frozen=True, kw_only=True, slots=True)
class ReaderPlan:
    """What a designer asks for."""

    size: str = ""
    """A name of `SIZES`; empty: small on a processor, full on a GPU."""
    minutes: float = 50.0
    """Of making data and training together."""
    epochs: int = 0
    """At most; 0: as many as there is time for."""
    presses: int = 0
    """Solved presses at most; 0: what suits the device."""
    views: int = 0
    """Rendered views at most; 0: likewise."""
    looks: int = 0
    """Built sensors that are learned from; 0: likewise."""
    jobs: int = 1
    batch: int = 0
    """Presses side by side; 0: what suits the device."""
    seed: int = 0
    start: ReaderFile | None = None
    """A reader to begin from; None: from nothing."""


@dataclass(frozen=True, kw_only=True, slots=True)
class TrainedReader:
    """What came of it."""

    path: Path
    scores: dict[str, Any]
    """On the built sensor and the places that test."""
    before: dict[str, Any] | None
    """The same of the reader that the training began from."""


def train_reader(
    design: SensorDesign,
    out: Path,
    project: Project,
    plan: ReaderPlan,
    *,
    tell: Callable[[Row], None],
    monitor: StageMonitor,
) -> TrainedReader:
    """Train a reader, or go on with a training.

    Args:
        design: The sensor.
        out: The reader's file.
        project: Its store has, or gets, mesh and light.
        plan: How long, how large.
        tell: Told each row of the curves.
        monitor: Progress of `data` and of `learn`, and cancellation.

    Raises:
        DesignError: If the design's seen skin is not the one that is touched.
        StoreError: If a file cannot be written, or the folder holds another training.
        WorkbenchError: From the stages, the solver and the renderer.
    """
    begun = time.monotonic()
    making, learning = (stage_monitor(monitor, stage) for stage in ("data", "learn"))
    device = torch_device()
    folder = training_folder(out)
    usual = spec_for(plan.size or ("full" if device == "cuda" else "small"), *_camera_px(design))
    spec, start = (usual, None) if plan.start is None else (plan.start.spec, plan.start.arrays)
    with held(folder, doing="training in"):
        mesh = stored(design, PressCase(), "mesh", project.store, part(making, 0.0, 0.01))
        if mesh.seen is not mesh.outer:
            raise DesignError(
                "the camera of this design sees the inner skin, not the one that is touched",
                hint="learned readers are for designs without pins: use --reader table",
                at="family",
            )
        _make(design, folder, project, plan, device=device, monitor=part(making, 0.01, 1.0))
        learned, validation, testing = _views(folder)
        scales = _scales(design, learned)
        spent = time.monotonic() - begun
        lesson = Lesson(
            learned=learned,
            validation=validation,
            spec=spec,
            scales=scales,
            seconds=60.0 * max(plan.minutes - spent / 60.0, LEAST_LEARNING * plan.minutes),
            epochs=plan.epochs,
            seed=plan.seed,
            device=device,
            key=digest((reader_digest(design), spec, plan.seed, len(learned), start)),
            start=start,
        )
        before = None
        if plan.start is not None:
            begins = lesson.network().eval().to(device)
            before = scores(judged(begins, testing, plan.start.scales, device, most=JUDGED_VIEWS))
        network, rows = learn(lesson, folder, _teller(tell, part(learning, 0.0, 0.97)))
        learning(0.97, "how far its deviations may be trusted")
        checked = scores(judged(network, validation, scales, device, most=JUDGED_VIEWS))
        scales = honest(scales, checked)
        tested = scores(judged(network, testing, scales, device, most=JUDGED_VIEWS))
        learning(0.99, "its file")
        card = card_of(learned, folder, rows, device=device, seed=plan.seed)
        card["scores"] = {"validation": checked, "test": tested}
        if plan.start is not None and before is not None:
            card["scores"]["before"] = before
            card["training"]["began_from"] = dict(plan.start.card)
        reader = ReaderFile(
            spec=spec,
            arrays=lesson.usable(network),
            scales=scales,
            rest=rest_view(mesh, design.optics, spec),
            design=design.name,
            digest=reader_digest(design),
            camera_px=_camera_px(design),
            card=card,
        )
        write_atomically(out, reader_bytes(reader))
        write_beside(out, card, rows)
    return TrainedReader(path=out, scores=tested, before=before)


def _camera_px(design: SensorDesign) -> tuple[int, int]:
    camera = design.optics.camera
    return camera.width_px, camera.height_px


def _make(
    design: SensorDesign,
    folder: Path,
    project: Project,
    plan: ReaderPlan,
    *,
    device: str,
    monitor: Monitor,
) -> None:
    """Make data unless it was made: what was stopped is gone on with.

    Raises:
        StoreError: If the data there is of another design.
        WorkbenchError: As `train_reader`.
    """
    marker = folder / MADE
    key = reader_digest(design)
    if marker.exists():
        if json.loads(marker.read_bytes()).get("digest") != key:
            raise StoreError(
                f"{folder} holds presses of another design, or of this one before it changed",
                hint="delete the folder, or give another --out",
                at=str(folder),
            )
        return
    most = AMOUNTS[device]
    amount = Amount(
        cases=plan.presses or most.cases,
        views=plan.views or most.views,
        looks=plan.looks or most.looks,
    )
    task = Task(
        design=design,
        folder=folder,
        amount=amount,
        minutes=plan.minutes,
        jobs=plan.jobs,
        batch=plan.batch,
        seed=plan.seed,
    )
    make_views(task, project, monitor=monitor)
    write_atomically(marker, json.dumps({"digest": key}).encode())


def _views(folder: Path) -> tuple[ViewSet, ViewSet, ViewSet]:
    """Views that are learned from, that validate and that test.

    Raises:
        StoreError: If a file is damaged.
        DesignError: If time was up before there were any of a kind.
    """
    found = [read_views(folder, f"{name}-*") for name in ("learned", "judged-0", "judged-1")]
    if not all(len(views) for views in found):
        (folder / MADE).unlink(missing_ok=True)
        raise DesignError(
            "time was up before there were views to learn from and to judge by",
            hint="run the same command with more --minutes: what is made is kept",
            at="--minutes",
        )
    learned, validation, testing = found
    return learned, validation, testing


def _scales(design: SensorDesign, learned: ViewSet) -> Scales:
    """Units: the elastomer's modulus, and the usual size of a force."""
    forces = np.array([view.force_N for view in learned.views if view.solved])
    usual_N = float(np.sqrt((forces**2).mean())) if len(forces) else 1.0
    return Scales(pressure_MPa=design.material.young_MPa, force_N=max(usual_N, 1e-3))


def _teller(tell: Callable[[Row], None], monitor: Monitor) -> Callable[[float, Row | None], None]:
    first: float | None = None

    def told(share: float, row: Row | None) -> None:
        nonlocal first
        # Of a training that goes on, time left is told by the pace of this run.
        first = min(share, 0.999) if first is None else first
        monitor(min((share - first) / (1.0 - first), 1.0), "learning")
        if row is not None:
            tell(row)

    return told
