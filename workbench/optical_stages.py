"""The stages of light and images: baking, tables, photons, pictures, maps.

Pure functions as those of `stages`, which names and numbers them.
"""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np

from workbench.core.camera import Camera
from workbench.core.indenter import Indenter
from workbench.core.light import LightField, NormalTable, VertexRadiance
from workbench.core.lighting import Baking, Lamp, LedRing, LightModel
from workbench.core.maps import DesignerMaps
from workbench.core.monitor import Monitor, part
from workbench.core.optics import Optics, Transport
from workbench.core.results import MembraneMesh
from workbench.core.sensing import Contact, Shot
from workbench.store import Store

PHOTON_BATCH = 5_000_000
"""Photons of a part: some ten seconds on two cores."""


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


def photon_parts(store: Store, inputs: tuple[Any, ...]) -> list[tuple[str, tuple[Any, ...]]]:
    """The batches of photons that `shoot` needs, camera by camera and frame by frame.

    Of their number of photons only the batch's own is in a key: more photons go on from there.
    """
    mesh, _, optics, contact, *_ = inputs
    if optics.light_model is not LightModel.PHOTONS:
        return []
    frames = len(store.load(contact.stage, contact.key).reaction_N)
    baking = Baking(seed=optics.baking.seed)
    transport = dataclasses.replace(optics.transport, baking=baking)
    total = optics.baking.photons
    # Each light emits as many photons as the others.
    batch = -(-PHOTON_BATCH // optics.lights) * optics.lights
    scene = (mesh, optics.ring, optics.lamps)
    return [
        (
            "photons",
            (
                *scene,
                camera,
                transport,
                contact if frame else None,
                frame,
                first,
                min(batch, total - first),
            ),
        )
        for camera in optics.all_cameras
        for frame in range(frames + 1)
        for first in range(0, total, batch)
    ]


def shoot(
    mesh: MembraneMesh,
    light: LightField,
    optics: Optics,
    contact: Contact,
    table: NormalTable | None = None,
    indenter: Indenter | None = None,
    young_MPa: float = 0.0,
    poisson: float = 0.0,
    *batches: VertexRadiance,
    monitor: Monitor,
) -> Shot:
    """Images of all frames, the background first; `indenter` has texture finer than contact's."""
    start_device(monitor)
    from sim.metrics import measure
    from sim.optics.detail import open_detail
    from sim.optics.render import Studio

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
    return Shot(
        frames=seen[0],
        metrics=measure(mesh, contact, seen[0], light),
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
