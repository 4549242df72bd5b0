"""Dots printed on the skin, or white tips of its pins: they move with it and show its shear.

A dot is the set of skin points within half a diameter of its centre in the reference
configuration. A pixel is darkened where the reference place of what it sees lies in a dot, so dots
stretch, hide and refract with the skin without being projected.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim.optics.camera.camera import Rays, focal_px
from sim.optics.camera.lens import ANGULAR
from sim.optics.raster.gbuffer import GBuffer, interpolate
from sim.optics.raster.marker_patterns import pattern_places
from workbench.core.design.camera import Camera
from workbench.core.design.optics import MarkerPattern, Markers
from workbench.core.result.results import Skin

TIP_REFLECTANCE = 0.85
"""Share of the light that a white pin tip returns [1]; titanium dioxide paint, our choice."""

LEAST_COSINE = 0.3
"""Smallest cosine that widens a pixel's footprint [1]: edges seen flatter stay this sharp."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Dots:
    """Dots of one size on a skin."""

    centres_mm: np.ndarray
    """Reference positions [mm], shape (M, 3), float64."""
    radius_mm: float
    inked: np.ndarray
    """Triangles that a dot or its blurred edge can reach, shape (F,), bool."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Coverage:
    """Ink per pixel: which dot, and how much of the pixel it covers."""

    marker: np.ndarray
    """Nearest dot of each pixel, shape (N,), int32."""
    ink: np.ndarray
    """Covered share of each pixel, shape (N,), float32 in [0, 1]."""


def place_markers(skin: Skin, markers: Markers) -> np.ndarray:
    """Dot centres on the skin [mm], shape (M, 3); none when they are not visible.

    `even` takes vertices at least a spacing apart, farthest first from the highest, until every
    vertex is nearer than the spacing to a dot; `marker_patterns` has the others.

    Raises:
        DesignError: If the pattern cannot be laid on this skin.
    """
    if not markers.visible:
        return np.zeros((0, 3))
    if markers.pattern is not MarkerPattern.EVEN:
        return pattern_places(skin, markers)
    points = skin.points_mm
    chosen = [int(np.argmax(points[:, 2]))]
    nearest = np.full(len(points), np.inf)
    while True:
        nearest = np.minimum(nearest, np.linalg.norm(points - points[chosen[-1]], axis=1))
        farthest = int(np.argmax(nearest))
        if nearest[farthest] < markers.spacing_mm:
            return points[chosen]
        chosen.append(farthest)


def no_ink(pixels: int) -> Coverage:
    """Coverage of an image without dots."""
    return Coverage(marker=np.zeros(pixels, np.int32), ink=np.zeros(pixels, np.float32))


def print_dots(skin: Skin, markers: Markers, camera: Camera) -> Dots:
    """Dots on the skin, and the triangles that can hold their ink."""
    return dots_at(skin, place_markers(skin, markers), markers.diameter_mm / 2.0, camera)


def dots_at(skin: Skin, centres: np.ndarray, radius_mm: float, camera: Camera) -> Dots:
    """Dots of one radius about given points of a skin [mm], shape (M, 3)."""
    if not len(centres):
        return Dots(centres_mm=centres, radius_mm=0.0, inked=np.zeros(len(skin.faces), dtype=bool))
    from scipy.spatial import KDTree

    corners = skin.points_mm[skin.faces]
    middle = corners.mean(axis=1)
    size = np.linalg.norm(corners - middle[:, None], axis=2).max(axis=1)
    # No depth in the image exceeds the length of the body, whatever the pose of the camera.
    longest = float(np.linalg.norm(np.ptp(skin.points_mm, axis=0)))
    edge = 0.5 * longest / focal_px(camera) / LEAST_COSINE
    inked = KDTree(centres).query(middle)[0] <= radius_mm + edge + size
    return Dots(centres_mm=centres, radius_mm=radius_mm, inked=inked)


def ink(seen: GBuffer, *, dots: Dots, skin: Skin, camera: Camera, rays: Rays) -> Coverage:
    """Coverage of an image.

    The edge of a dot is a smoothstep one pixel footprint wide: depth (fisheye: range) over focal
    length, divided by the cosine of the viewing angle.

    Args:
        seen: What the pixels that see the skin see.
        dots: The dots on `skin`.
        skin: The undeformed skin.
        camera: Gives the size of a pixel.
        rays: Gives the viewing angle, and the number of pixels.
    """
    found = no_ink(len(rays.direction))
    near = np.flatnonzero(dots.inked[seen.face])
    if not near.size:
        return found
    from scipy.spatial import KDTree

    seen = seen.take(near)
    place = interpolate(skin.points_mm.astype(np.float32), skin.faces, seen)
    cosine = -np.einsum("ij,ij->i", seen.normal, rays.direction[seen.pixel])
    # A pixel of a pinhole spans a length over depth_z, one of a fisheye an angle over the range.
    away = np.abs(seen.depth_z_mm)
    if camera.lens in ANGULAR:
        away = np.linalg.norm(place - np.asarray(camera.position_mm, np.float32), axis=1)
    footprint = away / focal_px(camera) / np.maximum(cosine, LEAST_COSINE)
    distance, nearest = KDTree(dots.centres_mm).query(place)
    step = np.clip((dots.radius_mm - distance) / footprint + 0.5, 0.0, 1.0)
    found.ink[seen.pixel] = step * step * (3.0 - 2.0 * step)
    found.marker[seen.pixel] = nearest
    return found


def centroids(coverage: Coverage, count: int, width_px: int) -> np.ndarray:
    """Centre of each dot's ink [px], shape (count, 2), float32; NaN for a dot nobody sees.

    A dot cut by the image edge or by an occlusion reports the centre of the part in view.
    """
    inked = np.flatnonzero(coverage.ink > 0.0)
    share, marker = coverage.ink[inked].astype(np.float64), coverage.marker[inked]
    total = np.bincount(marker, share, minlength=count)
    with np.errstate(invalid="ignore"):
        column = np.bincount(marker, share * (inked % width_px + 0.5), minlength=count) / total
        row = np.bincount(marker, share * (inked // width_px + 0.5), minlength=count) / total
    return np.column_stack([column, row]).astype(np.float32).reshape(count, 2)
