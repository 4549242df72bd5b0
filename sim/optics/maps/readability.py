"""How far a depth read from one photograph is off by noise, before any photograph is taken.

A reading (`sim.reading`) minimises, over the inward displacement h of the skin's vertices,

    sum over pixels  ((J . tilt(h) - change) / noise)^2  +  integral (Lap h)^2 / k^2 + h^2 / s^2.

Where the skin looks alike around a place, with vertices a distance d apart on a square grid, waves
of h of the phases (x, y) from vertex to vertex are then known with the precision, per area,

    p(x, y) = b^2 t^T Q t + (2 (2 - cos x - cos y) / d^2)^2 / k^2 + 1 / s^2,
    t = (sin x (2 + cos y), sin y (2 + cos x)) / (3 d),   b^2 = (2 + cos x) (2 + cos y) / 9,

Q being the sum of J_c J_c^T / noise_c^2 over the colours, per area of a pixel. The normal of a
vertex is the mean of the slopes around it, t, which does not see waves of two vertices; a pixel
sees the light of vertices blended, b^2 being the mean over its places. The variance of h is the
mean of 1 / p over all phases, over d^2.
Source: Wiener filter of a stationary field; Press and others, Numerical Recipes, 3rd ed., 13.3.
Left out: errors of the light, shadows, skin that is seen from one side only, that a contact is
small, and that J is another where skin is tilted. In three places each of pad, finger, trunk and
paw, with 1 grey level of noise, it is .8 to 1.7 of the standard deviation by noise that a reading
tells of a dent of .3 mm there, .5 to 1.8 of one of .6 mm, and .2 to 1.6 of one of 1 mm, whose
steep sides and shadows tell less.
"""

from __future__ import annotations

import numpy as np

from sim.optics.maps.signal import DENT_MM, dent_slope_deg, sensitivity_grey
from sim.optics.maps.skin_look import SkinLook
from workbench.core.result.results import Skin

CURVATURE_PER_MM, MOVED_MM = 0.25, 1.5
"""k and s of a reading."""
WAVES = 24
"""Along each axis of half the waves of the grid."""
PHOTOS = 2.0
"""A difference of two photographs has twice the variance of one."""
SURE = 3.0
"""Standard deviations from which a dent is told from none."""
LEAST_GREY = 1.2
"""Change of a pixel from which a reading looks at all."""
LEAST_NOISE_GREY = 1.0
"""That a photograph is given where the design's camera has less: few cameras do."""
PARCEL = 4096
"""Vertices that are summed at once, for memory."""


def depth_error_mm(skin: Skin, look: SkinLook) -> np.ndarray:
    """Standard deviation of a depth read from one photograph [mm], shape (V,); NaN unseen.

    Args:
        skin: The seen skin.
        look: What a camera tells of it.
    """
    by_slope = np.degrees(1.0) * look.jacobian.astype(np.float64)
    by_slope /= np.sqrt(PHOTOS) * np.maximum(look.noise, LEAST_NOISE_GREY)[:, :, None]
    told = np.einsum("vci,vcj->vij", by_slope, by_slope)
    told /= np.maximum(look.mm_per_pixel, 1e-6)[:, None, None] ** 2
    apart_mm = vertex_spacing_mm(skin)
    found = np.empty(len(told))
    for first in range(0, len(told), PARCEL):
        some = slice(first, first + PARCEL)
        found[some] = np.sqrt(grid_variance(told[some], apart_mm[some]))
    return np.where(look.visible & np.isfinite(look.mm_per_pixel), found, np.nan)


def grid_variance(told: np.ndarray, apart_mm: np.ndarray) -> np.ndarray:
    """Variance of h [mm2] at places with Q (n, 2, 2) [1/mm2] and spacings (n,) [mm], shape (n,)."""
    # Of x and -x one is enough; middles of cells leave out the wave that nothing is known of.
    line = np.pi * (np.arange(WAVES) + 0.5) / WAVES
    x, y = (each.ravel() for each in np.meshgrid(np.concatenate([-line, line]), line))
    d = apart_mm[:, None]
    beside_x, beside_y = (2.0 + np.cos(x)) / 3.0, (2.0 + np.cos(y)) / 3.0
    blend = np.sqrt(beside_x * beside_y)
    tilt_x = blend * beside_y * np.sin(x) / d
    tilt_y = blend * beside_x * np.sin(y) / d
    precision = told[:, 0, 0, None] * tilt_x**2 + told[:, 1, 1, None] * tilt_y**2
    precision += 2.0 * told[:, 0, 1, None] * tilt_x * tilt_y
    bent = 2.0 * (2.0 - np.cos(x) - np.cos(y)) / d**2
    precision += (bent / CURVATURE_PER_MM) ** 2 + MOVED_MM**-2
    return (1.0 / precision).mean(axis=1) / apart_mm**2


def vertex_spacing_mm(skin: Skin) -> np.ndarray:
    """Distance of a square grid with as many vertices per area, shape (V,)."""
    from geometry.surface.surface import vertex_areas_mm2

    return np.sqrt(np.maximum(vertex_areas_mm2(skin.points_mm, skin.faces), 1e-6))


def readable_dent_mm(look: SkinLook, error_mm: np.ndarray) -> np.ndarray:
    """Least depth [mm] of a ball of 6 mm that a reading tells from none, shape (V,).

    Its change must be seen, which grows with the root of the depth, and its depth be sure.

    Args:
        look: What a camera tells of the skin.
        error_mm: As `depth_error_mm`.
    """
    change = sensitivity_grey(look.jacobian, dent_slope_deg(DENT_MM)).astype(np.float64)
    noise = np.maximum(look.noise, LEAST_NOISE_GREY).mean(axis=1)
    least = np.maximum(LEAST_GREY, np.sqrt(PHOTOS) * noise)
    seen_mm = DENT_MM * (least / np.maximum(change, 1e-6)) ** 2
    return np.maximum(SURE * error_mm, seen_mm)
