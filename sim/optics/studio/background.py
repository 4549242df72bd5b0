"""A photograph of the real sensor at rest as the background that a contact is added to.

The photograph's display values are decoded by the sensor's curve, and divided by the exposure and
by what the lens keeps: the radiance that, developed, is the photograph again. The images of a
contact are then what the camera would show, as far as the rendered light is that of the sensor.

Exposure and white balance of the real camera are unknown, so unless the design states an exposure
each colour is tied to the photograph: its mean light over the pixels that see the skin and are not
at an end of the scale is that of the rendered background.
Source: SimTac composes its images over real ones in display values; here light is added to light.
"""

from __future__ import annotations

import numpy as np

from sim.optics.raster.display import choose_exposure, light_of
from sim.optics.raster.photo_file import read_rgb
from workbench.core.base.errors import DesignError
from workbench.core.design.camera import Camera
from workbench.core.design.photo import Photo

FIELD = "optics.background"
DARKEST, BRIGHTEST = 0.001, 0.98
"""Display light between which a pixel tells how much light there was [1]: 3 grey levels of sRGB, in
the noise, and where whites are cut off."""
LEAST_COLOUR = 1e-3
"""Share of the strongest colour's light below which the lights lack a colour [1]."""


def photo_light(photo: Photo, camera: Camera) -> np.ndarray:
    """Display light of a photograph, shape (H, W, 3), float32.

    Args:
        photo: The file; it must have the camera's width and height.
        camera: Gives the size and the curve of the display values.

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
    return light_of(shown, camera.sensor).astype(np.float32)


def tied_exposure(photo: np.ndarray, rendered: np.ndarray) -> np.ndarray:
    """Display light per radiance of each colour that gives the photograph's mean light, (3,).

    Args:
        photo: Display light of the pixels that see the skin, shape (P, 3).
        rendered: Their rendered radiance as it falls on the image sensor, shape (P, 3).

    A colour that the lights lack, or that is at an end of the scale everywhere, takes the exposure
    of the others.
    """
    usable = (photo > DARKEST) & (photo < BRIGHTEST)
    taken = np.where(usable, photo, 0.0).sum(axis=0)
    given = np.where(usable, rendered, 0.0).sum(axis=0)
    known = (taken > 0.0) & (given > LEAST_COLOUR * given.max(initial=0.0))
    if not known.any():
        return np.full(3, choose_exposure(rendered))
    together = taken[known].sum() / given[known].sum()
    return np.where(known, taken / np.where(known, given, 1.0), together)
