"""A photograph of the real sensor at rest as the background that a contact is added to.

The photograph's display values are decoded by the curve of sRGB, or by the sensor's gamma where it
has one, and divided by the exposure: the radiance that, developed with that exposure, is the
photograph again. The images of a contact are then what the camera would show, as far as the
rendered light is that of the real sensor; the exposure must come from the rendered background.
Source: SimTac composes its images over real ones in display values; here light is added to light.
"""

from __future__ import annotations

import numpy as np

from sim.optics.raster.display import srgb_decode
from sim.optics.raster.photo_file import read_rgb
from workbench.core.base.errors import DesignError
from workbench.core.design.camera import Camera
from workbench.core.design.photo import Photo

FIELD = "optics.background"


def photo_radiance(photo: Photo, camera: Camera, exposure: float) -> np.ndarray:
    """Linear radiance of a photograph, shape (H, W, 3), float32.

    Args:
        photo: The file; it must have the camera's width and height.
        camera: Gives the size and the curve of the display values.
        exposure: Display light per radiance, above 0.

    Raises:
        DesignError: If the file cannot be read, is CMYK, or has another size than the camera.
    """
    shown = read_rgb(photo, at=FIELD, ground=0.0)
    height, width = shown.shape[:2]
    if (width, height) != (camera.width_px, camera.height_px):
        raise DesignError(
            f"the background {photo.name} has {width} x {height} pixels, the camera "
            f"{camera.width_px} x {camera.height_px}",
            hint=f"save it at {camera.width_px} x {camera.height_px}, or set the camera's "
            f"width_px = {width} and height_px = {height}",
            at=FIELD,
        )
    gamma = camera.sensor.gamma
    light = srgb_decode(shown) if gamma == 0.0 else shown**gamma
    return (light / exposure).astype(np.float32)
