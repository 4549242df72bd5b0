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
    rest, sight, contact = reader.rest, touch.sight, touched(touch)
    values = np.column_stack([touch.inward_mm, touch.sigma_mm, contact, normals])
    # Most pixels see what they saw at rest.
    moved = ((touch.inward_mm != 0.0) | (touch.sigma_mm != 0.0) | contact)[rest.skin.faces]
    other = moved.any(axis=1)[sight.face] | (sight.face != rest.sight.face)
    at = np.flatnonzero(rest.sees & other)
    found = reader.rest_maps.copy()
    found[at] = np.nan
    at = at[sight.face[at] >= 0]
    found[at] = sight.blended(values, rest.skin.faces, at)
    found[at, 3:] /= np.linalg.norm(found[at, 3:], axis=1, keepdims=True)
    maps = found.reshape(*rest.shape, -1)
    with np.errstate(invalid="ignore"):
        touches = maps[:, :, 2] > 0.5
    return PixelMaps(
        depth_mm=maps[:, :, 0], normal=maps[:, :, 3:], contact=touches, sigma_mm=maps[:, :, 1]
    )
