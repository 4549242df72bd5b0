"""Direct glare: LEDs that the camera sees, and their mirror images in the wall of the cavity.

A pixel's straight ray from the camera may end on a cavity LED's disc; its mirror image in the
cavity wall may, dimmed by Fresnel's reflectance; its bent ray in the clear solid may, for LEDs in
the shell, times T / n^2 for the way out of the solid. A disc of area A that emits I(angle) has the
radiance I / (A cos(angle)), I = P I0 cos^m. The glare of a pixel is that radiance over the radiance
of the skin behind it as it arrives in the cavity, both averaged over the colours: above 1 the LED
outshines the skin.

Left out: light reflected more than once, lens flare, and what hides an LED from a bent or mirrored
ray.
"""

from __future__ import annotations

import dataclasses

import numpy as np

from sim.optics.camera.camera import Rays, pixel_centres, pixel_directions
from sim.optics.camera.refraction import refract
from workbench.core.design.camera import Camera
from workbench.core.result.light import LightField
from workbench.core.result.results import Skin

WIDEST_PX = 320
"""Glare is looked for on an image this wide: an LED of 1.5 mm at 20 mm then spans 15 pixels."""


def small(camera: Camera) -> Camera:
    """The same camera with no more pixels than glare needs."""
    share = min(1.0, WIDEST_PX / camera.width_px)
    size = {
        name: max(16, round(share * getattr(camera, name))) for name in ("width_px", "height_px")
    }
    return dataclasses.replace(camera, **size)


def led_radiance(
    origin_mm: np.ndarray, direction: np.ndarray, light: LightField, length_mm: np.ndarray
) -> np.ndarray:
    """Radiance of the LED discs that rays meet within their length, shape (R, 3).

    Args:
        origin_mm: Starts, shape (R, 3).
        direction: Unit directions, shape (R, 3).
        light: Gives the LEDs.
        length_mm: How far each ray goes before it meets something else, shape (R,).
    """
    found = np.zeros((len(direction), 3))
    for number, centre in enumerate(light.led_mm):
        axis = light.led_axis[number]
        cosine = -(direction @ axis)
        facing = cosine > 1e-3
        along = ((origin_mm - centre) @ axis) / np.where(facing, cosine, 1.0)
        place = origin_mm + along[:, None] * direction
        radius = light.led_size_mm[number] / 2.0
        on_disc = np.linalg.norm(place - centre, axis=1) < radius
        met = facing & (cosine > light.led_cone[number]) & (along > 0.0) & (along < length_mm)
        met &= on_disc
        exponent = light.led_exponent[number]
        power = (exponent + 1.0) / (2.0 * np.pi * (1.0 - light.led_cone[number] ** (exponent + 1)))
        shining = power * cosine[met] ** (exponent - 1.0) / (np.pi * radius**2)
        found[met] += shining[:, None] * light.led_rgb[number]
    return found


def glare_radiance(
    camera: Camera, rays: Rays, cavity: Skin, light: LightField, refractive_index: float
) -> np.ndarray:
    """Radiance of LEDs and their mirror images in each pixel, shape (H * W, 3).

    Args:
        camera: A small camera will do.
        rays: Its bent rays in the clear solid.
        cavity: The wall that mirrors.
        light: Gives the LEDs.
        refractive_index: Of the solid.
    """
    from geometry.surface.rays import RayCaster

    straight = pixel_directions(camera, pixel_centres(camera))
    eye = np.broadcast_to(np.asarray(camera.position_mm, dtype=np.float64), straight.shape)
    distance, face, weights = RayCaster(cavity.points_mm, cavity.faces).hits(eye, straight)
    total = led_radiance(eye, straight, light, distance)
    beyond = np.full(len(straight), np.inf)
    total += (
        (rays.transmittance / refractive_index**2)[:, None]
        * led_radiance(
            rays.origin_mm.astype(np.float64), rays.direction.astype(np.float64), light, beyond
        )
        * (face >= 0)[:, None]
    )
    met = np.flatnonzero(face >= 0)
    normal = np.einsum("nk,nkd->nd", weights[met], cavity.normals[cavity.faces[face[met]]])
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    _, passed = refract(straight[met], normal, index_from=1.0, index_to=refractive_index)
    along = np.einsum("nd,nd->n", straight[met], normal)
    mirrored = straight[met] - 2.0 * along[:, None] * normal
    place = eye[met] + distance[met, None] * straight[met]
    reflected = led_radiance(place, mirrored, light, np.full(len(met), np.inf))
    total[met] += (1.0 - passed)[:, None] * reflected
    return total
