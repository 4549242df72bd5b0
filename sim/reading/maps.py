"""What a read touch looks like from the camera: depth, normals, contact and deviation by pixel."""

from __future__ import annotations

import numpy as np

from sim.reading.pixel_maps import PixelMaps, pressed
from sim.reading.reader import Reader, Touch


def touched(touch: Touch) -> np.ndarray:
    """Vertices that are surely pressed in, shape (V,), bool."""
    if touch.contact is not None:
        return touch.contact
    return pressed(touch.inward_mm, touch.sigma_mm)


def seen_by_pixels(reader: Reader, touch: Touch, values: np.ndarray) -> np.ndarray:
    """Values of the vertices, (V,) or (V, C), where pixels see the moved skin: (H, W, C).

    NaN where they see none; float32.
    """
    rows, columns = reader.rest.shape
    sight, faces = touch.sight, reader.rest.skin.faces
    sees = np.flatnonzero(reader.rest.sees & (sight.face >= 0))
    wide = values.reshape(len(values), -1)
    found = np.full((rows * columns, wide.shape[1]), np.nan)
    found[sees] = sight.blended(wide, faces, sees)
    return found.reshape(rows, columns, -1).astype(np.float32)


def pixel_maps(reader: Reader, touch: Touch, normals: np.ndarray) -> PixelMaps:
    """A touch as the camera sees it; unit normals of the moved vertices, (V, 3), are its own."""

    def seen(values: np.ndarray) -> np.ndarray:
        return seen_by_pixels(reader, touch, values)

    normal = seen(normals)
    with np.errstate(invalid="ignore"):
        normal /= np.linalg.norm(normal, axis=2, keepdims=True)
        contact = seen(touched(touch).astype(np.float64))[:, :, 0] > 0.5
    return PixelMaps(
        depth_mm=seen(touch.inward_mm)[:, :, 0],
        normal=normal,
        contact=contact,
        sigma_mm=seen(touch.sigma_mm)[:, :, 0],
    )
