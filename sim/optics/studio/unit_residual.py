"""What one built sensor shows beyond its design's light: its image at rest, and a residual.

The residual is a change of grey levels that depends on how far the skin is tilted and where the
pixel is:

    r_c(s, p) = fade(|s|) sum over m of w_mc exp(-|(s, p) / reach - z_m|^2 / 2)

with the slopes s of the skin against rest, along the image's two axes, and the pixel's place p from
the middle of the image over half its diagonal. It vanishes away from slopes and places that were
photographed, where the design's light alone predicts, and at skin that is not tilted.
Source: ridge regression on Gaussian kernels with inducing places, Rasmussen and Williams (2006),
section 8.3.1; `workbench.calibration.residual` fits it.
"""

from __future__ import annotations

import functools
import io
from dataclasses import dataclass

import numpy as np

from sim.optics.camera.camera import rotation_camera_to_sensor
from workbench.core.base.errors import DesignError
from workbench.core.design.camera import Camera
from workbench.core.design.photo import Photo, photo
from workbench.core.design.unit import Unit

FORMAT = 1
FIELD = "optics.unit"
FADE_SLOPE = 0.02
"""Slope from which the residual counts in full [1]: about a degree."""
STEEPEST = 3.0
"""Slopes beyond are cut: skin nearly along the line of sight [1]."""
AT_ONCE = 4096
"""Pixels whose residual is summed at once: 400 kernels each are some 7 MB."""


@dataclass(frozen=True, kw_only=True, slots=True)
class UnitResidual:
    """M kernels over two slopes and two coordinates of the image."""

    idle: Photo
    """The sensor at rest."""
    centres: np.ndarray
    """Slopes and places over their reach, shape (M, 4), float32."""
    weights: np.ndarray
    """[grey level], shape (M, 3), float32."""
    reach: np.ndarray
    """Standard deviations of the kernels: of slopes [1] twice, of places [1] twice, shape (4,)."""

    def change(self, slope: np.ndarray, place: np.ndarray) -> np.ndarray:
        """Change of grey levels, shape (P, 3), at slopes (P, 2) and places (P, 2)."""
        found = np.zeros((len(slope), 3), dtype=np.float32)
        if not len(self.centres):
            return found
        fade = np.clip(np.linalg.norm(slope, axis=1) / FADE_SLOPE, 0.0, 1.0)
        at = (np.hstack([slope, place]) / self.reach).astype(np.float32)
        for first in range(0, len(at), AT_ONCE):
            rows = slice(first, first + AT_ONCE)
            found[rows] = kernels(at[rows], self.centres) @ self.weights
        return found * fade[:, None].astype(np.float32)


def kernels(at: np.ndarray, centres: np.ndarray) -> np.ndarray:
    """exp(-|a - z|^2 / 2), shape (P, M), of points (P, 4) and centres (M, 4)."""
    square = (at**2).sum(axis=1)[:, None] + (centres**2).sum(axis=1) - 2.0 * at @ centres.T
    return np.exp(-0.5 * np.maximum(square, 0.0))


def slopes(normal: np.ndarray, rest: np.ndarray, camera: Camera) -> np.ndarray:
    """Slopes of the skin against rest along the image's columns and rows, shape (P, 2).

    Args:
        normal: Unit normals facing the camera, shape (P, 3).
        rest: Those at rest, shape (P, 3).
        camera: Its axes, projected onto the skin at rest, are the directions.
    """
    across = rotation_camera_to_sensor(camera)[:, 0]
    along = across - (rest @ across)[:, None] * rest
    along /= np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-6)
    beside = np.cross(rest, along)
    upright = np.maximum(np.einsum("pi,pi->p", normal, rest), 0.1)
    found = [-np.einsum("pi,pi->p", normal, way) / upright for way in (along, beside)]
    return np.clip(np.column_stack(found), -STEEPEST, STEEPEST)


def places(pixel: np.ndarray, width_px: int, height_px: int) -> np.ndarray:
    """Places of pixels by number, over half the image's diagonal from its middle, (P, 2)."""
    half = np.hypot(width_px, height_px) / 2.0
    column, row = pixel % width_px + 0.5 - width_px / 2, pixel // width_px + 0.5 - height_px / 2
    return np.column_stack([column, row]) / half


def unit_bytes(
    idle_png: bytes, centres: np.ndarray, weights: np.ndarray, reach: np.ndarray
) -> bytes:
    """The file of a unit."""
    buffer = io.BytesIO()
    np.savez_compressed(
        buffer,
        format=FORMAT,
        idle_png=np.frombuffer(idle_png, dtype=np.uint8),
        centres=centres.astype(np.float32),
        weights=weights.astype(np.float32),
        reach=reach.astype(np.float32),
    )
    return buffer.getvalue()


@functools.lru_cache(maxsize=4)
def read_unit(unit: Unit) -> UnitResidual:
    """What a unit's file holds.

    Raises:
        DesignError: If it is damaged, newer, or none.
    """
    try:
        with np.load(io.BytesIO(unit.data.tobytes()), allow_pickle=False) as file:
            arrays = {name: file[name] for name in file.files}
        made = int(arrays["format"])
        idle = photo(f"{unit.name}.png", arrays["idle_png"].tobytes(), at=FIELD)
        found = UnitResidual(
            idle=idle,
            centres=arrays["centres"].astype(np.float32),
            weights=arrays["weights"].astype(np.float32),
            reach=arrays["reach"].astype(np.float32),
        )
    except Exception as error:
        raise DesignError(
            f"{unit.name} cannot be read as a unit: {error}",
            hint="name the unit.npz that `workbench calibrate` wrote, or leave optics.unit out",
            at=FIELD,
        ) from error
    shapes = found.centres.shape[1:], found.weights.shape, found.reach.shape
    finite = all(np.isfinite(a).all() for a in (found.centres, found.weights, found.reach))
    if made != FORMAT or shapes != ((4,), (len(found.centres), 3), (4,)) or not finite:
        raise DesignError(
            f"{unit.name} is a unit of format {made} that this program does not read",
            hint="calibrate again with this version",
            at=FIELD,
        )
    return found
