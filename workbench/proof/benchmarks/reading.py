"""Reading: photographs of the finger in a second, by its light and by its learned reader.

The photographs are renders of a dent, a grey level of noise on them, 320 x 240: how fast a reader
is does not depend on who photographed, how right it is stands in the room `reading` of `validate`.
In a video the dent moves and each reading starts from the one before.
"""

from __future__ import annotations

import functools
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from workbench.calibration.stored import lit_studio, stored
from workbench.core.base.monitor import silent
from workbench.core.design.design import SensorDesign
from workbench.core.press.press_case import PressCase
from workbench.core.result.results import MembraneMesh
from workbench.pipeline.devices import open_device, torch_device
from workbench.project.named_designs import load_design
from workbench.project.project import Project
from workbench.proof.benchmarks.timing import median_s
from workbench.proof.row import Measurement, Row, bounded, stated
from workbench.proof.validation.reading.renders import dents, rendered, sized
from workbench.reading.design_reader import DesignReader, open_reader
from workbench.reading.find_reader import SHIPPED
from workbench.reading.learned_reader import LearnedReader
from workbench.reading.read_photo import read_photo

DESIGN = "geltip"
DEPTH_MM = 0.6
STEP_MM = 0.1
"""How far the dent of a video moves from frame to frame."""
FRAMES = 6
BATCH = 256
"""Photographs that a GPU reads at once."""
ALONE, VIDEO, LEARNED = 8.0, 15.0, 20.0
"""Limits on two cores [1/s]."""
BATCH_LIMIT = 500.0
"""Limit on a data-centre GPU [1/s]."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Sensor:
    """A sensor that is read, with photographs of it."""

    design: SensorDesign
    mesh: MembraneMesh
    opened: DesignReader
    idle: np.ndarray
    video: Sequence[np.ndarray]


def rows() -> list[Row]:
    """All rows of the room."""
    device = open_device()
    with tempfile.TemporaryDirectory() as folder:
        sensor = functools.cache(lambda: _sensor(Path(folder)))
        video = f"a video of {FRAMES} frames that begins anew each time, by light"
        learned = f"one photograph, by the learned reader, {torch_device()}"
        return [
            _row("reading_table", "one photograph, by light", lambda: _alone(sensor()), ALONE),
            _row("reading_table", video, lambda: _video(sensor()), VIDEO),
            _row("reading_learned", learned, lambda: _learned(sensor()), LEARNED),
            batch_row(device),
        ]


def batch_row(device: str) -> Row:
    """Photographs side by side; needs no body, so a machine without the CAD kernel may ask it."""
    case = f"{BATCH} photographs of {DESIGN} side by side, 320 x 240, learned reader, {device}"
    if device == "cuda":
        return bounded(
            "reading_batch", case, batch_per_s, unit="1/s", limit=BATCH_LIMIT, sense="min"
        )
    return stated("reading_batch", case, batch_per_s, unit="1/s")


def batch_per_s() -> float:
    """Photographs a second of a batch, from arrays in memory to arrays in memory."""
    from sim.reading.network.predictor import Predictor
    from sim.reading.network.reader_file import SUFFIX, load_reader

    reader = load_reader(SHIPPED / f"{DESIGN}{SUFFIX}")
    predictor = Predictor(reader, torch_device())
    shape = (BATCH, reader.spec.rows, reader.spec.columns, 3)
    photos = np.random.default_rng(1).integers(0, 256, shape, dtype=np.uint8)
    return BATCH / median_s(lambda: predictor.read(photos[0], photos))


def _row(name: str, case: str, measure: Measurement, limit: float) -> Row:
    words = f"{DESIGN}, 320 x 240, {case}"
    return bounded(name, words, measure, unit="1/s", limit=limit, sense="min")


def _sensor(folder: Path) -> Sensor:
    project = Project(folder)
    design = sized(load_design(DESIGN, project=project))
    mesh: MembraneMesh = stored(design, PressCase(), "mesh", project.store, silent)
    studio = lit_studio(design, mesh, project.store, silent, DESIGN)
    photos = rendered(studio, design, 1.0)
    still = np.zeros((len(mesh.seen.points_mm), 3), np.float32)
    idle = photos(still, 0)
    opened = open_reader(design, idle, project.store, monitor=silent)
    from sim.optics.raster.dents import dented

    dent = next(each for each in dents(opened) if each.depth_mm == DEPTH_MM)
    aside = np.cross(dent.toward, (0.0, 0.0, 1.0))
    aside /= np.linalg.norm(aside)
    video = []
    for number in range(FRAMES):
        from_mm = np.add(dent.from_mm, STEP_MM * number * aside)
        moved = dented(mesh.seen, replace(dent, from_mm=tuple(from_mm.tolist())))
        video.append(photos(moved, 1 + number))
    return Sensor(design=design, mesh=mesh, opened=opened, idle=idle, video=video)


def _alone(sensor: Sensor) -> float:
    return 1.0 / median_s(lambda: read_photo(sensor.opened, "photo", sensor.video[0]))


def _video(sensor: Sensor) -> float:
    def follow() -> None:
        before = None
        for photo in sensor.video:
            before = read_photo(sensor.opened, "photo", photo, before).touch

    return FRAMES / median_s(follow)


def _learned(sensor: Sensor) -> float:
    from sim.reading.network.reader_file import SUFFIX, load_reader

    reader = load_reader(SHIPPED / f"{DESIGN}{SUFFIX}")
    camera = sensor.design.optics.camera
    opened = LearnedReader(reader, camera, sensor.mesh, sensor.idle, torch_device())
    return 1.0 / median_s(lambda: opened.read("photo", sensor.video[0]))
