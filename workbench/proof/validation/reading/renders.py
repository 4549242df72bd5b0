"""Readings of analytic dents, photographed by the light that reads them and by photons.

Nine dents of a ball of 8 mm, .3, .6 and 1 mm deep at three places of the image. By the renderer's
own light the reader is compared with itself: the figures say what the method loses. Photons are of
the same tracer that baked that light, traced in the pose; their noise is that of their number.
Sensors that are built by hand, once but for their camera, say what a reading is worth without a
calibration, and whether it knows.

    python -m workbench.proof.validation.reading.renders --photons 64

makes the record: some minutes for each design on a CPU, with 4 million photons. Stopped, it goes on
with the next design.
"""

from __future__ import annotations

import argparse
import dataclasses
import json
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from workbench.calibration.stored import lit_studio, stored
from workbench.core.base.monitor import Monitor, silent
from workbench.core.design.design import SensorDesign
from workbench.core.press.press_case import PressCase
from workbench.core.result.results import MembraneMesh, Skin
from workbench.pipeline.store import Store
from workbench.project.named_designs import load_design
from workbench.project.project import Project
from workbench.reading.design_reader import DesignReader, open_reader
from workbench.reading.read_photo import read_photo
from workbench.system.record import Record
from workbench.system.terminal import complain
from workbench.system.whole_files import write_atomically
from workbench.twin.draw import Twin, draw_twin
from workbench.twin.photographer import Photographer
from workbench.twin.scoring import Scorer, mean_score
from workbench.twin.truth import Truth

if TYPE_CHECKING:
    # They need the device that is opened first.
    from sim.optics.raster.dents import Dent
    from sim.optics.studio.render import Studio

DESIGNS = ("pad", "geltip", "trunk", "paw")
SIZE_PX = (320, 240)
SPOTS = ((0.5, 0.5), (0.46, 0.66), (0.25, 0.375), (0.35, 0.6), (0.6, 0.5))
"""Row and column of dents over the size of the image."""
PLACES = 3
"""Of them, the first that are dents: a ball that is let into the skin beside a toe of the paw would
push that aside too, by up to 9 mm, as nothing here knows of contact."""
BESIDE_MM = 0.25
"""By which the deepest dent may displace skin farther than it is deep."""
DEPTHS_MM = (0.3, 0.6, 1.0)
INSIDE_MM = 3.0
"""From the skin, where the line of a dent begins."""
NOISE_GREY = 1.0
PHOTONS_MILLIONS = 4
BUILT_SEED, BUILT_NOISE_GREY = 3, 0.5
"""Of the sensor that is built by hand, and of the mean of four of its photographs."""

RECORD = Record(
    path=Path(__file__).with_name("renders.json"),
    command="python -m workbench.proof.validation.reading.renders --photons 64",
    sources=(
        "workbench.proof.validation.reading.renders",
        "sim.reading",
        "sim.optics.field.models",
    ),
    apart=(
        "sim.contact",
        "sim.fem",
        "sim.forces",
        "sim.reading.network",
        "workbench.learning",
        "workbench.system",
        "workbench.view",
        "workbench.proof.row",
    ),
)

Photos = Callable[[np.ndarray, int], np.ndarray]
"""Photographs (H, W, 3), uint8, of the skin displaced by (V, 3) [mm]; number 0 is at rest."""


def figures(names: Sequence[str], photons_millions: int, store: Store) -> dict[str, Any]:
    """Scores of designs by what photographed them, as the record holds them.

    Raises:
        WorkbenchError: From the stages that mesh, trace and read.
    """
    code, designs = RECORD.code(), {}
    for name in names:
        path = store.root.parent / "renders" / f"{name}_{photons_millions}_{code}.json"
        if not path.exists():
            found = _figures(name, photons_millions, store)
            write_atomically(path, json.dumps(found, allow_nan=False).encode())
        designs[name] = json.loads(path.read_bytes())
    return {"photons_millions": photons_millions, "designs": designs}


def _figures(name: str, photons_millions: int, store: Store) -> dict[str, Any]:
    design = sized(load_design(name, project=Project(store.root.parent)))
    mesh: MembraneMesh = stored(design, PressCase(), "mesh", store, silent)
    studio = lit_studio(design, mesh, store, silent, name)
    twin = Twin(seed=0, design=design, exposure_factor=1.0, ball_error_mm=0.0)
    photographer = Photographer(twin, mesh, 1_000_000 * photons_millions, _told(name))
    ways: dict[str, Photos] = {
        "renders": rendered(studio, design, 0.0),
        "noise": rendered(studio, design, NOISE_GREY),
        "photons": lambda moved, number: (
            photographer.photograph(moved, number, silent) if number else photographer.at_rest()
        ),
    }
    for way, built in (("lamps", lamps_off(design)), ("built", built_by_hand(design))):
        lit = lit_studio(built, mesh, store, silent, f"{name}, {way}")
        ways[way] = rendered(lit, built, BUILT_NOISE_GREY)
    found: dict[str, Any] = {}
    for way, photos in ways.items():
        complain(f"{name}: {way}")
        found[way] = scored(design, mesh, photos, store)
    return found


def scored(
    design: SensorDesign, mesh: MembraneMesh, photos: Photos, store: Store
) -> dict[str, float | None]:
    """The mean score of readings of the dents, and of how many."""
    still = np.zeros((len(mesh.seen.points_mm), 3), np.float32)
    opened = open_reader(design, photos(still, 0), store, monitor=silent)
    scorer, scores = Scorer(opened), []
    from sim.optics.raster.dents import dented

    for number, dent in enumerate(dents(opened), start=1):
        moved = dented(mesh.seen, dent)
        reading = read_photo(opened, dent.name, photos(moved, number))
        scores.append(scorer.score(reading, known(mesh.seen, moved, dent.name)))
    return {"count": float(len(scores)), **mean_score(scores).figures}


def dents(opened: DesignReader) -> list[Dent]:
    """The dents of a design: where the pixels of `SPOTS` see skin that a ball may press alone."""
    from sim.optics.raster.dents import Dent, DentKind, dented

    rest, found = opened.reader.rest, []
    rows, columns = rest.shape
    for row, column in SPOTS:
        pixel = int(row * rows) * columns + int(column * columns)
        if not rest.sees[pixel]:
            continue
        corners = rest.skin.faces[rest.sight.face[pixel]]
        inward = rest.skin.inward[corners].mean(axis=0)
        inward /= np.linalg.norm(inward)
        begin = rest.sight.weights[pixel] @ rest.skin.points_mm[corners] + INSIDE_MM * inward
        here = [
            Dent(
                name=f"{row:g},{column:g},{depth_mm:g}",
                kind=DentKind.SPHERE,
                from_mm=tuple(begin.tolist()),
                toward=tuple((-inward).tolist()),
                depth_mm=depth_mm,
            )
            for depth_mm in DEPTHS_MM
        ]
        farthest_mm = float(np.linalg.norm(dented(opened.mesh.seen, here[-1]), axis=1).max())
        if farthest_mm <= DEPTHS_MM[-1] + BESIDE_MM:
            found += here
        if len(found) == PLACES * len(DEPTHS_MM):
            break
    return found


def known(skin: Skin, moved: np.ndarray, name: str) -> Truth:
    """What is known of an analytic dent: the surface, and no force."""
    nothing = np.zeros(3)
    return Truth(
        rest_mm=skin.points_mm,
        displaced_mm=skin.points_mm + moved,
        faces=skin.faces,
        normals=skin.normals,
        pressure_MPa=np.zeros(0),
        contact_force_N=np.zeros((0, 3)),
        force_N=np.full(3, np.nan),
        object_pose=np.full(7, np.nan),
        target_mm=nothing,
        depth_mm=float("nan"),
        object_name=name,
    )


def rendered(studio: Studio, design: SensorDesign, noise_grey: float) -> Photos:
    """Photographs by a studio, in whole grey levels, each with noise of its own."""
    from sim.optics.raster.display import shown

    sensor, exposure = design.optics.camera.sensor, studio.exposure

    def photo(moved: np.ndarray, number: int) -> np.ndarray:
        light = studio.linear(moved[None].astype(np.float32))[0] * exposure
        grey = 255.0 * shown(np.clip(light, 0.0, 1.0), sensor)
        noise = np.random.default_rng((1, number)).normal(0.0, 1.0, grey.shape)
        return np.clip(np.round(grey + noise_grey * noise), 0, 255).astype(np.uint8)

    return photo


def built_by_hand(design: SensorDesign) -> SensorDesign:
    """The design with the optics of a twin: lamps, coating and camera are off as if by hand."""
    return dataclasses.replace(design, optics=draw_twin(design, BUILT_SEED).design.optics)


def lamps_off(design: SensorDesign) -> SensorDesign:
    """The same with the design's own camera."""
    built = built_by_hand(design)
    optics = dataclasses.replace(built.optics, camera=design.optics.camera)
    return dataclasses.replace(design, optics=optics)


def sized(design: SensorDesign) -> SensorDesign:
    """The design with images of `SIZE_PX`."""
    width_px, height_px = SIZE_PX
    camera = dataclasses.replace(design.optics.camera, width_px=width_px, height_px=height_px)
    return dataclasses.replace(design, optics=dataclasses.replace(design.optics, camera=camera))


def _told(name: str) -> Monitor:
    last = [-1]

    def monitor(fraction: float, note: str = "") -> None:
        tenth = int(10.0 * fraction)
        if tenth > last[0]:
            last[0] = tenth
            complain(f"{name}: light {10 * tenth} %")

    return monitor


def main(words: Sequence[str]) -> int:
    """Make the record."""
    from workbench.pipeline.devices import open_device

    parser = argparse.ArgumentParser(description="readings of dents beside what they are")
    parser.add_argument("designs", nargs="*", default=list(DESIGNS))
    parser.add_argument("--photons", type=int, default=PHOTONS_MILLIONS, help="millions")
    parser.add_argument("--project", type=Path, default=Path("proof"), help="keeps the light")
    options = parser.parse_args(words)
    open_device()
    store = Project(options.project).store
    RECORD.make(lambda: figures(options.designs or DESIGNS, options.photons, store))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
