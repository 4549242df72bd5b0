"""What cameras tell of each vertex of the skin: pixels, angle, change by tilt, noise, glare.

With several cameras a vertex counts as seen when any camera sees it; the rest is that of the camera
that has the most pixels there.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence

import numpy as np

from sim.optics.camera.camera import refracted_rays
from sim.optics.maps import pixel_glare, seeing, signal
from sim.optics.maps.display_light import display_light, pixels_of
from sim.optics.maps.skin_look import SkinLook
from sim.optics.studio.render import Studio
from workbench.core.base.monitor import Monitor, part
from workbench.core.design.camera import Camera
from workbench.core.design.optics import Optics
from workbench.core.result.light import LightField, NormalTable
from workbench.core.result.results import MembraneMesh


def look_of(
    mesh: MembraneMesh,
    light: LightField,
    optics: Optics,
    table: NormalTable | None,
    camera: Camera,
    monitor: Monitor,
) -> SkinLook:
    """What one camera tells of the undeformed skin."""
    studio = Studio(
        mesh, light, optics, table=table, camera=camera, monitor=part(monitor, 0.0, 0.6)
    )
    skin, visible, sensor = mesh.seen, studio.visible, camera.sensor
    inward = -skin.normals
    uv = studio.vertex_pixels[:, :2]

    shown = display_light(studio, camera)
    at_rest = shown(inward)
    return SkinLook(
        visible=visible,
        mm_per_pixel=seeing.mm_per_pixel(skin.points_mm, skin.faces, uv, visible),
        incidence_deg=seeing.incidence_deg(inward, studio.to_camera, visible),
        jacobian=signal.tilt_jacobian(shown, inward, sensor),
        noise=signal.noise_grey(at_rest, sensor),
        glare=_glare(mesh, light, optics, studio, camera),
        overexposed=(at_rest >= 1.0).any(axis=1),  # pyright: ignore[reportArgumentType]
    )


def _glare(
    mesh: MembraneMesh, light: LightField, optics: Optics, studio: Studio, camera: Camera
) -> np.ndarray:
    """Glare over the skin's radiance at each vertex, shape (V,), as the nearest pixel sees it."""
    small = pixel_glare.small(camera)
    rays = refracted_rays(small, mesh.cavity, optics.refractive_index)
    shining = pixel_glare.glare_radiance(small, rays, mesh.cavity, light, optics.refractive_index)
    pixel, in_image = pixels_of(studio, camera, small)
    found = shining.mean(axis=1)[pixel]
    # Both as they arrive in the air of the cavity: T / n^2 of the radiance in the solid.
    leaving = rays.transmittance[pixel] / optics.refractive_index**2
    skin = leaving * studio.shade_tilted(mesh.seen.normals).mean(axis=1)
    ratio = found / np.maximum(skin, 1e-12)
    return np.where(studio.visible & in_image, ratio, np.nan).astype(np.float32)


def best_look(looks: Sequence[SkinLook]) -> SkinLook:
    """At each vertex the camera with the most pixels there."""
    if len(looks) == 1:
        return looks[0]
    # A vertex that one camera sees without a whole triangle still belongs to that camera.
    sizes = np.stack(
        [
            np.where(look.visible, np.nan_to_num(look.mm_per_pixel, nan=1e9), np.inf)
            for look in looks
        ]
    )
    chosen = np.argmin(sizes, axis=0)
    every = np.arange(len(chosen))

    taken = {
        field.name: np.stack([getattr(look, field.name) for look in looks])[chosen, every]
        for field in dataclasses.fields(SkinLook)
    }
    # Seen by any, not only by the one that is chosen where none has a pixel.
    return SkinLook(**{**taken, "visible": np.any([look.visible for look in looks], axis=0)})
