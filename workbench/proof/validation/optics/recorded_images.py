"""What the product shows of the recorded scenes: traced photons, and the default light model.

In Mitsuba's units: radiance in air, 1 / n^2 of that behind the wall.
"""

from __future__ import annotations

import dataclasses

import numpy as np

from workbench.core.base.monitor import silent
from workbench.core.design.lighting import LightModel
from workbench.core.design.optics import BEST, Composition, Optics
from workbench.proof.validation.optics.recorded_scenes import (
    RecordedScene,
    body_of,
    displacement_mm,
)

PHOTONS = 4_000_000
"""In two halves, whose difference is their error."""


def photon_halves(scene: RecordedScene, optics: Optics, photons: int = PHOTONS) -> np.ndarray:
    """Two images of a scene with different photons, shape (2, H, W, 3), float64.

    Args:
        scene: Gives the body and its dent.
        optics: The scene's own; others are shown for what a wrong product would show.
        photons: Of both.
    """
    from sim.optics.light.lights import place_leds
    from sim.optics.transport.paths import Photons
    from sim.optics.transport.radiance import trace_radiance

    moved, leds = displacement_mm(scene), place_leds(optics.ring)
    half, found = photons // 2, []
    for first in (0, half):
        traced = trace_radiance(
            body_of(scene),
            leds,
            optics.camera,
            optics.transport,
            Photons(count=half, seed=optics.baking.seed, first=first),
            displacement_mm=moved if scene.dented else None,
        )
        radiance = traced.radiance * (len(leds.rgb) / traced.photons)
        found.append(_drawn(scene, optics, radiance))
    return np.stack(found)


def _drawn(scene: RecordedScene, optics: Optics, radiance: np.ndarray) -> np.ndarray:
    """Radiance at the vertices (V, 3) as an image (H, W, 3)."""
    from sim.optics.field.bake import bake_light
    from sim.optics.studio.render import Studio

    model = LightModel("photons")
    light = bake_light(body_of(scene), optics.ring, model=model)
    optics = dataclasses.replace(optics, light_model=model)
    studio = Studio(body_of(scene), light, optics, radiance=radiance)
    image = studio.linear(displacement_mm(scene)[None], radiance=radiance[None])[0]
    return _as_seen(image, studio.exposure, optics)


def best_image(scene: RecordedScene, optics: Optics) -> np.ndarray:
    """A scene under the default light model, shape (H, W, 3), float64."""
    from sim.optics.studio.render import Studio
    from workbench.pipeline.stages.bake import BakeInputs, bake
    from workbench.pipeline.stages.table import TableInputs, table

    mesh, transport = body_of(scene), optics.transport
    light = bake(
        BakeInputs(mesh=mesh, ring=optics.ring, lamps=(), model=BEST, transport=transport),
        monitor=silent,
    )
    cameras = optics.all_cameras
    found = table(
        TableInputs(mesh=mesh, light=light, cameras=cameras, transport=transport, model=BEST),
        monitor=silent,
    )
    optics = dataclasses.replace(optics, composition=Composition.ABSOLUTE)
    studio = Studio(mesh, light, optics, table=found)
    image = studio.linear(displacement_mm(scene)[None])[0]
    return _as_seen(image, studio.exposure, optics)


def _as_seen(image: np.ndarray, exposure: np.ndarray, optics: Optics) -> np.ndarray:
    """Radiance in air, with what the lens keeps of it at each pixel."""
    lens = exposure / exposure.max()
    return image.astype(np.float64) * lens / optics.refractive_index**2
