"""The stage `shoot`: images of all frames, the background first, and the measures of the press.

It finds the table toward the cameras, the maps and the photons of its frames as parts of its own:
they are stored like other results, and a camera that moves makes only the image anew.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from sim.optics.field.model import model_of
from workbench.core.base.monitor import Monitor, part
from workbench.core.design.camera import Camera
from workbench.core.design.lighting import Baking
from workbench.core.design.optics import Optics
from workbench.core.press.indenter import Indenter
from workbench.core.result.light import LightField, NormalTable, VertexRadiance
from workbench.core.result.maps import DesignerMaps
from workbench.core.result.results import MembraneMesh
from workbench.core.result.sensing import Contact, Metrics, Shot
from workbench.pipeline.devices import start_device
from workbench.pipeline.seen_optics import seen_optics
from workbench.pipeline.stage import PART, Call, Chain, Stage
from workbench.pipeline.stages import maps, photons, table
from workbench.pipeline.stages.object import shape_only
from workbench.pipeline.store import Store
from workbench.pipeline.surface_detail import detailed
from workbench.view.map_display import scores

PHOTON_BATCH = 1_000_000
"""Photons of a part: some two to four seconds on two cores."""


@dataclass(frozen=True, kw_only=True, slots=True)
class ShootInputs:
    """What images depend on."""

    mesh: MembraneMesh
    light: LightField
    optics: Optics
    contact: Contact
    young_MPa: float
    indenter: Indenter | None = None
    """An object with texture finer than contact's."""
    poisson: float = 0.0
    table: NormalTable | None = field(default=None, metadata=PART)
    maps: DesignerMaps | None = field(default=None, metadata=PART)
    photons: tuple[VertexRadiance, ...] = field(default=(), metadata=PART)
    """Batches, camera by camera and frame by frame."""


def inputs(chain: Chain) -> ShootInputs:
    """The skin, its light and its contact."""
    design, case = chain.design, chain.case
    fine = detailed(design.optics, case.indenter, case.settings)
    return ShootInputs(
        mesh=chain.result("mesh"),
        light=chain.result("bake"),
        optics=seen_optics(design.optics),
        contact=chain.result("press"),
        young_MPa=design.material.young_MPa,
        indenter=None if fine is None else shape_only(fine),
        poisson=0.0 if fine is None else design.material.poisson,
    )


def parts(given: ShootInputs, store: Store) -> dict[str, Any]:
    """Table, maps and photons."""
    seen, mesh, light = given.optics, given.mesh, given.light
    calls: dict[str, Any] = {}
    looked_up = table.table_inputs(seen, mesh, light)
    if looked_up is not None:
        calls["table"] = table.STAGE.call(looked_up)
    mapped = maps.maps_inputs(seen, mesh, light, given.young_MPa)
    if mapped is not None:
        calls["maps"] = maps.STAGE.call(mapped)
    calls["photons"] = tuple(_photon_calls(given, store))
    return calls


def _photon_calls(given: ShootInputs, store: Store) -> list[Call]:
    optics, transport = given.optics, given.optics.transport
    if not model_of(optics.light_model).per_frame:
        return []
    contact: Any = given.contact
    frames = len(store.load(contact.stage, contact.key).reaction_N)
    total, baking = optics.baking.photons, Baking(seed=optics.baking.seed)
    # Each light emits as many photons as the others.
    batch = -(-PHOTON_BATCH // optics.lights) * optics.lights
    return [
        photons.STAGE.call(
            photons.PhotonsInputs(
                mesh=given.mesh,
                ring=optics.ring,
                lamps=optics.lamps,
                camera=Camera(position_mm=camera.position_mm),
                transport=dataclasses.replace(transport, baking=baking),
                contact=contact if frame else None,
                frame=frame,
                first_photon=first,
                count=min(batch, total - first),
            )
        )
        for camera in optics.all_cameras
        for frame in range(frames + 1)
        for first in range(0, total, batch)
    ]


def shoot(given: ShootInputs, *, monitor: Monitor) -> Shot:
    """Images of all frames and what they measure."""
    start_device(monitor)
    from sim.optics.studio.detail import open_detail
    from sim.optics.studio.metrics import measure
    from sim.optics.studio.render import Studio

    mesh, light, contact, optics = given.mesh, given.light, given.contact, given.optics
    detail = open_detail(
        given.indenter, mesh, contact, young_MPa=given.young_MPa, poisson=given.poisson
    )
    moved = mesh.seen_displacement_mm(contact)
    cameras = optics.all_cameras
    radiance = _radiance(given.photons, len(light.led_mm), len(cameras), len(moved) + 1)
    seen = []
    for number, camera in enumerate(cameras):
        span = part(monitor, 0.9 * number / len(cameras), 0.9 * (number + 1) / len(cameras))
        rest = radiance[number][0] if radiance else None
        later = radiance[number][1] if radiance else None
        studio = Studio(
            mesh, light, optics, table=given.table, camera=camera, radiance=rest, monitor=span
        )
        seen.append(studio.shoot(moved, radiance=later, detail=detail, monitor=span))
    values = measure(mesh, contact, seen[0], light).values
    if given.maps is not None:
        values = values | scores(given.maps)
    return Shot(frames=seen[0], metrics=Metrics(values=values), others=tuple(seen[1:]))


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
        emitted = sum(batch.photons for batch in group)
        means.append(lights / emitted * np.sum([batch.radiance for batch in group], axis=0))
    of_camera = np.stack(means).astype(np.float32).reshape(cameras, frames, *means[0].shape)
    return [(one[0], one[1:]) for one in of_camera]


STAGE = Stage(
    name="shoot",
    label="Image",
    version=7,
    place=12,
    lane="sim",
    run=shoot,
    inputs=inputs,
    parts=parts,
    in_run=True,
    on_strip=True,
)
