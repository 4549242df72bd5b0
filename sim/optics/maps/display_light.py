"""Light of the skin at rest as a camera displays it, if its normals were others."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from sim.optics.studio.render import Studio
from workbench.core.design.camera import Camera


def display_light(studio: Studio, camera: Camera) -> Callable[[np.ndarray], np.ndarray]:
    """Display light (V, 3) of the undeformed skin at its pixels, by its inward normals (V, 3).

    Wall and lens dim it; of vertices outside the image it is not dimmed.
    """
    pixel, seen = pixels_of(studio, camera, camera)
    share = studio.rays.transmittance[pixel]
    exposure = studio.exposure.reshape(-1, 3)[pixel]
    dimmed = exposure * np.where(seen, share, 1.0)[:, None]
    return lambda inward: dimmed * studio.shade_tilted(-inward)


def pixels_of(studio: Studio, camera: Camera, image: Camera) -> tuple[np.ndarray, np.ndarray]:
    """Pixel of each vertex in an image of the same camera, and whether it has one, (V,) each."""
    uv = studio.vertex_pixels[:, :2]
    place = np.nan_to_num(uv * (image.width_px / camera.width_px)).astype(int)
    column = np.clip(place[:, 0], 0, image.width_px - 1)
    row = np.clip(place[:, 1], 0, image.height_px - 1)
    return row * image.width_px + column, np.isfinite(uv.sum(axis=1))
