"""Photographs of a design laid on its camera's pixels, where only their number differs.

A calibrated sensor is looked at with fewer pixels than it was photographed with: in previews, in
packs, in data sets. What it shows at rest, in display values, is averaged over the new pixels; a
camera would average light, but at rest a pixel and its neighbours differ by little. A photograph
of another proportion, or of fewer pixels than the camera's, is left as it is, and refused where it
is used.
"""

from __future__ import annotations

import dataclasses
import functools

import numpy as np

from sim.optics.raster.photo_file import read_rgb
from sim.optics.studio.background import FIELD
from sim.optics.studio.unit_residual import read_unit, unit_bytes
from workbench.core.design.optics import Optics
from workbench.core.design.photo import Photo, photo
from workbench.core.design.unit import Unit, unit

Size = tuple[int, int]
"""Width and height [px]."""


def fitted_photos(optics: Optics) -> Optics:
    """The optics, whose photographed background and built sensor have the camera's pixels.

    Raises:
        DesignError: If a photograph cannot be read.
    """
    if optics.background is None and optics.unit is None:
        return optics
    size_px = optics.camera.width_px, optics.camera.height_px
    background = optics.background and _photo_in(optics.background, size_px)
    built = optics.unit and _unit_in(optics.unit, size_px)
    return dataclasses.replace(optics, background=background, unit=built)


@functools.lru_cache(maxsize=16)
def _photo_in(shown: Photo, size_px: Size) -> Photo:
    rgb = read_rgb(shown, at=FIELD, ground=0.0)
    height_px, width_px = rgb.shape[:2]
    alike = abs(width_px * size_px[1] - height_px * size_px[0]) <= max(width_px, height_px)
    if not alike or size_px[0] >= width_px:
        return shown
    import cv2

    found = np.rint(255.0 * cv2.resize(rgb, size_px, interpolation=cv2.INTER_AREA)).clip(0, 255)
    png = cv2.imencode(".png", found.astype(np.uint8)[:, :, ::-1])[1].tobytes()
    return photo(f"{shown.name}.png", png, at=FIELD)


@functools.lru_cache(maxsize=16)
def _unit_in(built: Unit, size_px: Size) -> Unit:
    held = read_unit(built)
    idle = _photo_in(held.idle, size_px)
    if idle is held.idle:
        return built
    # The residual's places are shares of the image.
    return unit(built.name, unit_bytes(idle.data.tobytes(), held.centres, held.weights, held.reach))
