"""Light fields for tests of image formation: baked where that is quick, else made up but smooth."""

from __future__ import annotations

import dataclasses

import numpy as np

from sim.optics.field.bake import bake_light
from sim.optics.field.model import model_of
from workbench.core.design.lighting import LedRing, LightModel
from workbench.core.result.light import AZIMUTHS, SINES, TILTS, LightField, NormalTable, Scattered
from workbench.core.result.results import MembraneMesh

UNTRACED = [model for model in LightModel if not model_of(model).traced]
SHADED = [model for model in LightModel if model is not LightModel.PHOTONS]


def lit(
    mesh: MembraneMesh, model: LightModel, ring: LedRing | None = None
) -> tuple[LightField, NormalTable | None]:
    """Light of a model, and its table where it has one.

    Traced models get straight lines as unscattered light, and a table that falls off with the tilt
    of the normal, in another colour toward +X than toward -X.
    """
    ring = ring or LedRing()
    if not model_of(model).traced:
        return bake_light(mesh, ring, model=model), None
    light = bake_light(mesh, ring, model=LightModel.DIRECT)
    skin = mesh.seen
    nodes = np.arange(0, len(skin.points_mm), 7)
    normal = -skin.normals[nodes]
    side = np.cross(normal, [0.3, 0.5, 0.8])
    side /= np.linalg.norm(side, axis=1, keepdims=True)
    frame = np.stack([side, np.cross(normal, side), normal], axis=1).astype(np.float32)
    from scipy.spatial import KDTree

    gaps, near = KDTree(skin.points_mm[nodes]).query(skin.points_mm, k=3)
    shares = 1.0 / (gaps + 0.3)
    bins = np.full((len(nodes), 3, AZIMUTHS * (len(SINES) - 1)), 1e-6, dtype=np.float32)
    scattered = Scattered(
        frame=frame,
        first=bins,
        rest=bins,
        nodes=np.asarray(near, dtype=np.int32),
        weights=(shares / shares.sum(axis=1, keepdims=True)).astype(np.float32),
        balance={},
        photons=0,
    )
    tilt = np.linspace(-1.0, 1.0, TILTS)
    fall = 1.4 - 0.6 * (tilt[:, None] ** 2 + tilt[None] ** 2) + 0.5 * tilt[:, None]
    colour = 1.0 + 0.4 * np.outer(np.sin(skin.points_mm[nodes, 0] / 10.0), [1.0, 0.0, -1.0])
    strength = 0.3 * float(light.irradiance.mean())
    values = strength * fall[None, :, :, None] * colour[:, None, None, :]
    light = dataclasses.replace(light, model=str(model), scattered=scattered)
    return light, NormalTable(values=values[None].astype(np.float32))
