"""The stages of light and images: baking, tables, photons, pictures, maps.

Pure functions as those of `stages`, which names and numbers them.
"""

from __future__ import annotations

import numpy as np

from workbench.core.camera import Camera
from workbench.core.indenter import Indenter
from workbench.core.light import LightField, NormalTable, VertexRadiance
from workbench.core.lighting import Lamp, LedRing, LightModel
from workbench.core.maps import DesignerMaps
from workbench.core.monitor import Monitor, part
from workbench.core.optics import Optics, Transport
from workbench.core.results import MembraneMesh
from workbench.core.sensing import Contact, Metrics, Shot
from workbench.map_display import scores


def bake(
    mesh: MembraneMesh,
    ring: LedRing,
    lamps: tuple[Lamp, ...],
    model: LightModel,
    transport: Transport | None = None,
    *,
    monitor: Monitor,
) -> LightField:
    """Light of each LED at each vertex of the skin."""
    from sim.optics.bake import bake_light

    if transport is not None:
        start_device(monitor)
    return bake_light(mesh, ring, lamps, model=model, transport=transport, monitor=monitor)


def table(
    mesh: MembraneMesh,
    light: LightField,
    cameras: tuple[Camera, ...],
    transport: Transport,
    model: LightModel,
    *,
    monitor: Monitor,
) -> NormalTable:
    """Traced light as radiance toward each camera, by the tilt of the skin's normal."""
    start_device(monitor)
    from sim.optics.table import tabulate

    return tabulate(light, mesh, cameras, transport, model=model, monitor=monitor)


def start_device(monitor: Monitor) -> None:
    """Open the compute device, telling that it takes a moment."""
    from workbench.devices import open_device

    monitor(0.0, "opening the device")
    open_device()


def photons(
    mesh: MembraneMesh,
    ring: LedRing,
    lamps: tuple[Lamp, ...],
    camera: Camera,
    transport: Transport,
    contact: Contact | None,
    frame: int,
    first_photon: int,
    count: int,
    *,
    monitor: Monitor,
) -> VertexRadiance:
    """One batch of photons of one frame; frame 0 is the undeformed skin."""
    start_device(monitor)
    from sim.optics.lights import place_leds
    from sim.optics.transport.radiance import trace_radiance

    moved = None if contact is None else mesh.seen_displacement_mm(contact)[frame - 1]
    return trace_radiance(
        mesh,
        place_leds(ring, lamps),
        camera,
        transport,
        photons=count,
        first_photon=first_photon,
        displacement_mm=moved,
        monitor=monitor,
    )


def shoot(
    mesh: MembraneMesh,
    light: LightField,
    optics: Optics,
    contact: Contact,
    young_MPa: float,
    indenter: Indenter | None = None,
    poisson: float = 0.0,
    *parts: NormalTable | DesignerMaps | VertexRadiance,
    monitor: Monitor,
) -> Shot:
    """Images of all frames, the background first, and the measures of press and design.

    `indenter` has texture finer than contact's; the parts are those of `light_calls.shoot_parts`.
    """
    start_device(monitor)
    from sim.metrics import measure
    from sim.optics.detail import open_detail
    from sim.optics.render import Studio

    table = next((found for found in parts if isinstance(found, NormalTable)), None)
    batches = tuple(found for found in parts if isinstance(found, VertexRadiance))
    detail = open_detail(indenter, mesh, contact, young_MPa=young_MPa, poisson=poisson)
    moved = mesh.seen_displacement_mm(contact)
    cameras = optics.all_cameras
    radiance = _radiance(batches, len(light.led_mm), len(cameras), len(moved) + 1)
    seen = []
    for number, camera in enumerate(cameras):
        span = part(monitor, 0.9 * number / len(cameras), 0.9 * (number + 1) / len(cameras))
        rest = radiance[number][0] if radiance else None
        later = radiance[number][1] if radiance else None
        studio = Studio(
            mesh, light, optics, table=table, camera=camera, radiance=rest, monitor=span
        )
        seen.append(studio.shoot(moved, radiance=later, detail=detail, monitor=span))
    values = measure(mesh, contact, seen[0], light).values
    for found in parts:
        if isinstance(found, DesignerMaps):
            values = values | scores(found)
    return Shot(
        frames=seen[0],
        metrics=Metrics(values=values),
        others=tuple(seen[1:]),
    )


def _radiance(
    batches: tuple[VertexRadiance, ...], lights: int, cameras: int, frames: int
) -> list[tuple[np.ndarray, np.ndarray]]:
    """Radiance (V, 3) of each camera's undeformed skin and (K, V, 3) of its frames; [] of none."""
    if not batches:
        return []
    share = len(batches) // (cameras * frames)
    means = []
    for start in range(0, len(batches), share):
        group = batches[start : start + share]
        photons = sum(batch.photons for batch in group)
        means.append(lights / photons * np.sum([batch.radiance for batch in group], axis=0))
    of_camera = np.stack(means).astype(np.float32).reshape(cameras, frames, *means[0].shape)
    return [(one[0], one[1:]) for one in of_camera]


def maps(
    mesh: MembraneMesh,
    light: LightField,
    optics: Optics,
    young_MPa: float,
    table: NormalTable | None = None,
    *,
    monitor: Monitor,
) -> DesignerMaps:
    """Where on the skin this design sees, and how well."""
    start_device(monitor)
    from sim.optics.maps.measure import designer_maps

    return designer_maps(mesh, light, optics, table, young_MPa=young_MPa, monitor=monitor)
