"""Radiance toward a camera straight from photons: the slow reference, for any deformed skin.

Each photon that meets the coating sends flux f(wi, wo) along the ray to the camera, wi from where
it came, wo to the camera; divided among the three vertices about its place and by their areas that
is radiance. Source: density estimation on the mesh (Walter et al., Global illumination using local
linear density estimation, 1997). Its only bias is the size of a triangle.

Leaves out: what stands between skin and camera, which the renderer knows.
"""

from __future__ import annotations

import numpy as np

from geometry.surface.surface import face_areas
from sim.optics.light.lights import Leds
from sim.optics.transport.constants import FIXED_POINT
from sim.optics.transport.paths import Photons, trace_paths
from sim.optics.transport.scene import open_scene
from sim.optics.transport.sources import open_sources
from sim.optics.transport.tally import tally_toward_camera
from sim.optics.transport.view import directions_to_camera
from workbench.core.base.monitor import Monitor, silent
from workbench.core.design.camera import Camera
from workbench.core.design.optics import Transport
from workbench.core.result.light import VertexRadiance
from workbench.core.result.results import MembraneMesh


def trace_radiance(
    mesh: MembraneMesh,
    leds: Leds,
    camera: Camera,
    transport: Transport,
    photons: Photons,
    *,
    displacement_mm: np.ndarray | None = None,
    monitor: Monitor = silent,
) -> VertexRadiance:
    """One batch of photons as radiance at the vertices of the seen skin.

    The sum of batches, times the number of lights over the sum of their photons, is the radiance.

    Args:
        mesh: The skins.
        leds: The lights.
        camera: Whose radiance is asked for.
        transport: What photons meet.
        photons: Of this batch.
        displacement_mm: Of the seen skin's vertices [mm], shape (V, 3); None at rest.
    """
    scene = open_scene(mesh, transport, displacement_mm=displacement_mm)
    sources = open_sources(leds, scene)
    points = scene.points_mm[: scene.skin_points].astype(np.float64)
    to_camera = directions_to_camera(points, mesh, camera, transport.refractive_index)
    tally = tally_toward_camera(scene, to_camera)
    followed = trace_paths(scene, sources, tally, photons, monitor=monitor)
    faces = scene.faces[: scene.skin_faces]
    third = np.repeat(face_areas(points, faces) / 3.0, 3)
    area_mm2 = np.bincount(faces.ravel(), third, len(points))
    unit = sources.strongest / FIXED_POINT / np.maximum(area_mm2, 1e-9)
    return VertexRadiance(
        radiance=(tally.radiance * unit[:, None]).astype(np.float32),
        photons=followed,
        balance=tally.balance,
    )
