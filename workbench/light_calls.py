"""The calls of light: baking, tables, maps, photons, and what an image is made of.

`shoot` finds the table toward the cameras, the maps and the photons of its frames as parts of its
own: they are stored like other results, and a camera that moves makes only the image anew.
"""

from __future__ import annotations

import dataclasses
from typing import Any

from workbench.calls import Call, Ref
from workbench.core.camera import Camera
from workbench.core.lighting import TABULATED, Baking, LedRing, LightModel
from workbench.core.optics import Markers, Optics
from workbench.store import Store

PHOTON_BATCH = 1_000_000
"""Photons of a part: some two to four seconds on two cores."""


def bake_call(optics: Optics, mesh: Ref) -> Call:
    """Light on the skin; only traced light depends on coating and refractive index."""
    transport = optics.transport if optics.light_model in TABULATED else None
    return Call("bake", (mesh, optics.ring, optics.lamps, optics.light_model, transport))


def seen_optics(optics: Optics) -> Optics:
    """The optics without what the baked light, or the object that is passed, says already."""
    optics = dataclasses.replace(optics, detail=True)
    if optics.light_model is LightModel.PHOTONS:
        return optics
    model = optics.light_model if optics.light_model in TABULATED else LightModel.DIRECT
    return dataclasses.replace(optics, ring=LedRing(), lamps=(), baking=Baking(), light_model=model)


def table_calls(seen: Optics, mesh: Ref, light: Ref) -> tuple[Call, ...]:
    """The call `table` of the models that look radiance up."""
    if seen.light_model not in TABULATED:
        return ()
    eyes = tuple(_eye(camera) for camera in seen.all_cameras)
    return (Call("table", (mesh, light, eyes, seen.transport, seen.light_model)),)


def _eye(camera: Camera) -> Camera:
    """All that light on its way to a camera depends on: where it stands."""
    return Camera(position_mm=camera.position_mm)


def maps_calls(seen: Optics, mesh: Ref, light: Ref, young_MPa: float) -> tuple[Call, ...]:
    """The call `maps`; of photons traced for every frame there is no baked light to map."""
    if seen.light_model is LightModel.PHOTONS:
        return ()
    tables = (call.ref for call in table_calls(seen, mesh, light))
    optics = dataclasses.replace(
        seen, markers=Markers(), background=None, light_model=LightModel.DIRECT
    )
    return (Call("maps", (mesh, light, optics, young_MPa, *tables)),)


def shoot_parts(store: Store, inputs: tuple[Any, ...]) -> tuple[Call, ...]:
    """Table, maps and photons of a call of `shoot`."""
    mesh, light, seen, contact, young_MPa, *_ = inputs
    return (
        *table_calls(seen, mesh, light),
        *maps_calls(seen, mesh, light, young_MPa),
        *_photon_calls(store, mesh, seen, contact),
    )


def _photon_calls(store: Store, mesh: Ref, optics: Optics, contact: Ref) -> list[Call]:
    """The batches of photons of every frame, camera by camera and frame by frame.

    Of their number of photons only the batch's own is in a key: more photons go on from there.
    """
    transport = optics.transport
    if optics.light_model is not LightModel.PHOTONS or transport is None:
        return []
    frames = len(store.load(contact.stage, contact.key).reaction_N)
    total, baking = optics.baking.photons, Baking(seed=optics.baking.seed)
    transport = dataclasses.replace(transport, baking=baking)
    # Each light emits as many photons as the others.
    batch = -(-PHOTON_BATCH // optics.lights) * optics.lights
    scene = (mesh, optics.ring, optics.lamps)
    return [
        Call(
            "photons",
            (
                *scene,
                _eye(camera),
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
