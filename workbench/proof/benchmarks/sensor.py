"""`wb.Sensor` in a loop: forces and images of a moving ball and of a moving mesh, frame by frame.

The finger `geltip` at 320 x 240, from the default project: what it lacks is made first, minutes on
a new machine, and is not timed.
"""

from __future__ import annotations

import dataclasses
import functools
from collections.abc import Callable
from typing import Any

import numpy as np

from workbench.core.design.optics import MarkerPattern, Markers
from workbench.pipeline.devices import chosen_device
from workbench.project.named_designs import load_design
from workbench.proof.benchmarks import sensor_peers
from workbench.proof.benchmarks.timing import median_s
from workbench.proof.row import Row, bounded, stated
from workbench.sensor.making import make_pack
from workbench.sensor.sensor import Sensor
from workbench.sensor.tensor_frame import TensorFelt
from workbench.sensor.things import Thing

DESIGN, WIDTH_PX = "geltip", 320
FRAMES = 40
DEPTH_MM, WAY_MM = 0.6, 0.1
"""How deep the object stands, and how far it moves from frame to frame."""
TIP_MM = 42.0
LEAST_FPS = 60.0
BATCH = {"cpu": 16, "cuda": 256}
LEAST_BATCH_FPS: dict[str, dict[str, float]] = {
    "cpu": {},
    "cuda": {
        "sensor_batch": 2_500.0,
        "sensor_batch_forces": 20_000.0,
        "sensor_batch_markers": 1_000.0,
    },
}
"""Asked of a data-centre GPU; of a processor nothing is."""
HEAD_MM, SHANK_MM, LENGTH_MM = 6.0, 3.0, 4.0
"""Of the bolt: its hexagonal head meets the skin."""


def rows() -> list[Row]:
    """All rows of the room."""
    sensor = _sensor()
    moving = {"ball of 6 mm": sensor.object("sphere", size_mm=6.0), "bolt, a mesh": bolt(sensor)}
    found = []
    for name, thing in moving.items():
        found.append(
            bounded(
                "sensor_frames",
                f"{name} slides on {DESIGN}, {WIDTH_PX} px, one sensor: force and image",
                functools.partial(_rate, functools.partial(_follow, sensor.render, thing), FRAMES),
                unit="1/s",
                limit=LEAST_FPS,
                sense="min",
            )
        )
        found.append(
            stated(
                "sensor_forces",
                f"{name}, the same, forces alone",
                functools.partial(_rate, functools.partial(_follow, sensor.feel, thing), FRAMES),
                unit="1/s",
            )
        )
    ball = moving["ball of 6 mm"]
    batches = batch_rows(sensor, marked_sensor(), ball)
    return [*found, *batches, *sensor_peers.rows(sensor, poses(ball, FRAMES))]


def batch_rows(sensor: Sensor, marked: Sensor, ball: Thing) -> list[Row]:
    """Many sensors side by side, what they feel and see left on the device.

    Args:
        sensor: One without markers.
        marked: One with markers, whose places are asked for too.
        ball: What touches them.
    """
    device = chosen_device()
    count = BATCH[device]
    found = []
    for name, each, call, told in (
        ("sensor_batch", sensor, sensor.render_tensors, "force and image"),
        ("sensor_batch_forces", sensor, sensor.feel_tensors, "forces alone"),
        (
            "sensor_batch_markers",
            marked,
            functools.partial(_with_markers, marked),
            "force, image, depth and markers",
        ),
    ):
        pace = functools.partial(
            _rate, functools.partial(_batch, call, poses(ball, count), ball), count
        )
        least = LEAST_BATCH_FPS[device].get(name)
        size = " x ".join(str(side) for side in each.image_px)
        case = f"{count} sensors side by side on {device}, {size} px, tensors left there: {told}"
        found.append(
            stated(name, case, pace, unit="1/s")
            if least is None
            else bounded(name, case, pace, unit="1/s", limit=least, sense="min")
        )
    return found


@functools.cache
def _sensor() -> Sensor:
    return Sensor.load(DESIGN, width_px=WIDTH_PX)


def marked_sensor() -> Sensor:
    """The finger with a grid of dots, seen by its camera's own pixels."""
    design = load_design(DESIGN)
    dots = Markers(visible=True, pattern=MarkerPattern.GRID)
    optics = dataclasses.replace(design.optics, markers=dots)
    return Sensor(make_pack(dataclasses.replace(design, optics=optics)))


def _with_markers(sensor: Sensor, at: np.ndarray, thing: Thing) -> TensorFelt:
    """A moment of all, and where their dots are."""
    frame = sensor.render_tensors(at, thing)
    frame.markers_px.cpu()
    return frame


def poses(thing: Thing, count: int) -> np.ndarray:
    """Ways of an object over the tip, to and fro, shape (count, 7)."""
    step = np.arange(count)
    aside = WAY_MM * np.abs((step % 40) - 20)
    found = np.zeros((count, 7))
    found[:, 0] = aside - 1.0
    # Along the dome, so that it stays as deep.
    found[:, 2] = TIP_MM - 15.0 + np.sqrt(15.0**2 - found[:, 0] ** 2)
    found[:, 2] += thing.collider.half_height_mm - thing.centre_mm[2] - DEPTH_MM
    found[:, 3] = 1.0
    return found


def bolt(sensor: Sensor) -> Thing:
    """A hexagon bolt, its head down: a mesh, known by samples of its distance."""
    import trimesh

    head = trimesh.creation.cylinder(HEAD_MM / 2, 2.0, sections=6)
    shank = trimesh.creation.cylinder(SHANK_MM / 2, LENGTH_MM, sections=24)
    shank.apply_translation([0.0, 0.0, 1.0 + LENGTH_MM / 2 - 0.2])
    return sensor.object(trimesh.boolean.union([head, shank], engine="manifold"))


def _follow(call: Callable[[np.ndarray, Thing], Any], thing: Thing) -> None:
    """Call with one pose after the other."""
    for pose in poses(thing, FRAMES):
        call(pose, thing)


def _batch(call: Callable[[np.ndarray, Thing], TensorFelt], at: np.ndarray, thing: Thing) -> None:
    """One moment of all; read, so that a GPU has done it."""
    call(at, thing).slip.cpu()


def _rate(run: Callable[[], None], count: int) -> float:
    """Frames a second."""
    return count / median_s(run)
