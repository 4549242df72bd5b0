"""Optics: baking the light of the default finger, opening its camera, and images at video rate."""

from __future__ import annotations

import dataclasses
import functools
import time
from typing import TYPE_CHECKING

import numpy as np

from workbench.core.base.monitor import silent
from workbench.core.design.camera import Camera
from workbench.core.design.design import SensorDesign
from workbench.core.design.lighting import Baking, LedRing, LightModel
from workbench.core.design.optics import Optics
from workbench.core.result.light import LightField, NormalTable
from workbench.core.result.maps import DesignerMaps
from workbench.core.result.results import MembraneMesh
from workbench.pipeline.devices import open_device
from workbench.pipeline.stages.bake import BakeInputs, bake
from workbench.pipeline.stages.table import TableInputs, table
from workbench.proof.benchmarks.timing import RUNS, median_s, timed_row
from workbench.proof.row import Row, bounded
from workbench.proof.specimens import finger_mesh

if TYPE_CHECKING:
    from sim.optics.studio.render import Studio

FRAMES = 6
VIDEO_FRAMES = 40
PRESS_MM = 1.0
RADIUS_MM = 2.2
VIDEO_EDGE_MM = 0.32
"""Edges of the video's finger [mm]: 93K triangles, of whose vertices the dent moves some 2,500."""
TURN_RAD = 0.16
"""How far the dent of the video moves about the axis per frame."""
RISE_MM = 0.3
BAKES_S = {
    LightModel("linear"): 5.0,
    LightModel("plane_target"): 5.0,
    LightModel("plane_source"): 5.0,
    LightModel("plane_normal"): 5.0,
    LightModel("geodesic"): 10.0,
    LightModel("direct"): 5.0,
}
"""Longest bake of the default finger [s]."""
TRACED_S = 15.0
"""Longest bake of traced light at 5,000 nodes, with its table [s]."""
MAPS_S = 5.0
TRACED_RUNS = 3
VIDEO_FPS = {
    (LightModel("hybrid"), 640): 35.0,
    (LightModel("hybrid"), 320): 70.0,
    (LightModel("table"), 640): 40.0,
    (LightModel("table"), 320): 80.0,
}
"""Least frames per second on two cores, by model and width [px]."""


def dent(
    points_mm: np.ndarray, normals: np.ndarray, at_mm: tuple[float, float, float]
) -> np.ndarray:
    """A smooth dent of 1 mm, so that this room needs no contact, shape (V, 3), float32."""
    nearest = points_mm[np.argmin(((points_mm - at_mm) ** 2).sum(axis=1))]
    square = ((points_mm - nearest) ** 2).sum(axis=1)
    moved = -PRESS_MM * np.exp(-square / (2 * RADIUS_MM**2))[:, None] * normals
    moved[square > (3.5 * RADIUS_MM) ** 2] = 0.0
    return moved.astype(np.float32)


def travelling_dent(points_mm: np.ndarray, normals: np.ndarray, frames: int) -> np.ndarray:
    """A dent that winds up the finger [mm], shape (frames, V, 3), float32."""
    places = [
        (15.0 * np.cos(TURN_RAD * k), 15.0 * np.sin(TURN_RAD * k), 12.0 + RISE_MM * k)
        for k in range(frames)
    ]
    return np.stack([dent(points_mm, normals, place) for place in places])


@functools.cache
def optics_of(model: LightModel, width_px: int) -> Optics:
    """The default sensor with a light model and a width of its images."""
    camera = Camera(width_px=width_px, height_px=width_px * 3 // 4)
    return Optics(camera=camera, light_model=model)


@functools.cache
def video_mesh() -> MembraneMesh:
    """The finger of the video, in finer triangles than the default ones."""
    from sim.optics.proof.specimen import finger

    return finger(edge_mm=VIDEO_EDGE_MM)


@functools.cache
def video_light() -> LightField:
    """Traced light on it; `table` and `hybrid` share it."""
    optics = Optics(light_model=LightModel("hybrid"))
    traced = optics.transport
    return bake(
        BakeInputs(
            mesh=video_mesh(),
            ring=optics.ring,
            lamps=(),
            model=LightModel("hybrid"),
            transport=traced,
        ),
        monitor=silent,
    )


def video_studio(model: LightModel, width_px: int) -> Studio:
    """A studio for traced light."""
    from sim.optics.studio.render import Studio

    optics = optics_of(model, width_px)
    light = dataclasses.replace(video_light(), model=model.value)
    traced = optics.transport
    if traced is None:
        raise ValueError(f"{model.value} traces no light")
    found = table(
        TableInputs(
            mesh=video_mesh(),
            light=light,
            cameras=optics.all_cameras,
            transport=traced,
            model=model,
        ),
        monitor=silent,
    )
    return Studio(video_mesh(), light, optics, table=found)


def video_fps(model: LightModel, width_px: int) -> float:
    """Frames per second of images of a travelling dent, one call per frame as when live."""
    skin, studio = video_mesh().seen, video_studio(model, width_px)
    frames = travelling_dent(skin.points_mm, skin.normals, VIDEO_FRAMES)
    studio.images(frames[:1])
    times = []
    for frame in frames:
        begun = time.perf_counter()
        studio.images(frame[None])
        times.append(time.perf_counter() - begun)
    return 1.0 / float(np.median(times))


def _bakes() -> list[Row]:
    """Light of the default finger by every model that has any at rest."""
    ring = LedRing()
    plain = [
        timed_row(
            "bake",
            model.value,
            lambda model=model: bake(
                BakeInputs(mesh=finger_mesh(), ring=ring, lamps=(), model=model), monitor=silent
            ),
            limit_s,
        )
        for model, limit_s in BAKES_S.items()
    ]
    traced = [
        timed_row(
            "bake",
            f"{model.value}, {Baking().nodes} nodes, {Baking().photons // 10**6} M photons, "
            "with its table",
            lambda model=model: traced_light(finger_mesh(), model),
            TRACED_S,
            runs=TRACED_RUNS,
        )
        for model in (LightModel("table"), LightModel("hybrid"))
    ]
    return [*plain, *traced]


def traced_light(mesh: MembraneMesh, model: LightModel) -> tuple[LightField, NormalTable]:
    """Traced light and its table, as the two stages make them."""
    optics = Optics(light_model=model)
    traced = optics.transport
    if traced is None:
        raise ValueError(f"{model.value} traces no light")
    light = bake(
        BakeInputs(mesh=mesh, ring=optics.ring, lamps=(), model=model, transport=traced),
        monitor=silent,
    )
    return light, table(
        TableInputs(
            mesh=mesh, light=light, cameras=optics.all_cameras, transport=traced, model=model
        ),
        monitor=silent,
    )


def _maps() -> list[Row]:
    """All maps of the default finger, from light that is baked already."""
    from sim.optics.maps.measure import designer_maps

    light = functools.cache(lambda: traced_light(finger_mesh(), LightModel("hybrid")))
    optics = Optics(light_model=LightModel("hybrid"))
    young_MPa = SensorDesign().material.young_MPa

    def measure() -> DesignerMaps:
        field, looked_up = light()
        return designer_maps(finger_mesh(), field, optics, looked_up, young_MPa=young_MPa)

    return [
        timed_row(
            "maps_seconds", "hybrid, 640x480, baked already", measure, MAPS_S, runs=TRACED_RUNS
        )
    ]


def rows() -> list[Row]:
    """All rows of the room."""
    from sim.optics.studio.render import shoot

    open_device()
    optics = Optics()
    found = [*_bakes(), *_maps()]

    @functools.cache
    def light() -> LightField:
        return bake(
            BakeInputs(mesh=finger_mesh(), ring=optics.ring, lamps=(), model=LightModel("direct")),
            monitor=silent,
        )

    def seconds(frames: int, runs: int) -> float:
        outer = finger_mesh().outer
        moved = travelling_dent(outer.points_mm, outer.normals, frames)
        view = functools.partial(shoot, finger_mesh(), light(), optics, displacement_mm=moved)
        return median_s(view, runs=runs)

    first_s = functools.cache(lambda: seconds(1, RUNS))
    case = "640x480, 0.4 mm triangles"
    triangles = len(video_mesh().seen.faces) // 1000
    video = [
        bounded(
            "fps",
            f"{model.value}, {width_px}x{width_px * 3 // 4}, {triangles}K triangles",
            functools.partial(video_fps, model, width_px),
            unit="1/s",
            limit=least,
            sense="min",
        )
        for (model, width_px), least in VIDEO_FPS.items()
    ]
    return [
        *found,
        bounded(
            "image",
            case,
            lambda: (seconds(1 + FRAMES, 3) - first_s()) / FRAMES,
            unit="s",
            limit=0.1,
        ),
        bounded("first_image", f"{case}, camera just moved", first_s, unit="s", limit=5.0),
        *video,
    ]
