"""Height fields of textures, and the signed function of a textured body.

The lower surface is moved along -Z by the height h(x, y): the function of the textured body at a
place is that of the smooth body at (x, y, z + h s), where s is 1 below the body origin and falls
to 0 at the top, so that sides stay upright and edges rounded. The function is a distance no
more, which `redistance` cures.
Letters are drawn by OpenCV (Hershey's strokes) once, and their flanks by the distance to a stroke.
Left out: the displacement is along Z also where the smooth surface is steep.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from workbench.core.errors import DesignError
from workbench.core.texture import STEEPEST, Pattern, Texture

Heights = Callable[[np.ndarray], np.ndarray]
"""Heights [mm], shape (N,), at body places (N, 2)."""

LEAST_FEATURE_SAMPLES = 4.0
"""Width of the narrowest ridge in distance samples: fewer, and crests are lost."""
LETTER_PIXELS = 40
"""Pixels of a capital's height; heights between pixels are linear."""
HERSHEY_CAPITAL = 20.2
"""Height of a capital of OpenCV's simplex font in pixels at scale 1, as drawn."""
FILTER_SAMPLES = 1.5
"""Standard deviation of the filter that takes too fine detail out of an image, in samples."""


def heights(texture: Texture, spacing_mm: float) -> Heights:
    """The height field of a texture, for a distance that is sampled at `spacing_mm`.

    Raises:
        DesignError: If its ridges are too narrow for the samples, or an image too steep.
    """
    _check_resolved(texture, spacing_mm)
    if texture.pattern is Pattern.LETTERS:
        return _pixels(_lettering(texture), texture, texture.pitch_mm / LETTER_PIXELS)
    if texture.pattern is Pattern.IMAGE:
        return _image(texture, spacing_mm)
    return lambda place: _repeated(texture, place)


def textured(
    body: Callable[[np.ndarray], np.ndarray], field: Heights, top_mm: float
) -> Callable[[np.ndarray], np.ndarray]:
    """The smooth body's function with its lower side raised; `top_mm` is its upper end."""

    def function(place: np.ndarray) -> np.ndarray:
        share = np.clip(1.0 - place[:, 2] / top_mm, 0.0, 1.0)
        raised = place.copy()
        raised[:, 2] += field(place[:, :2]) * share
        return body(raised)

    return function


def displaced(points_mm: np.ndarray, field: Heights, top_mm: float) -> np.ndarray:
    """Surface points of the smooth body, (N, 3), moved onto the textured one."""
    moved = points_mm.copy()
    height, z = field(points_mm[:, :2]), points_mm[:, 2]
    # Solves new + height share(new) = z; the share is 1 wherever new is below the origin.
    moved[:, 2] = np.where(z <= height, z - height, (z - height) / (1.0 - height / top_mm))
    return moved


def sharpest_mm(texture: Texture) -> float:
    """Least radius of curvature of a crest [mm]; infinite for none and for an image."""
    if not texture.raised or not texture.height_mm:
        return float("inf")
    return 2.0 * texture.flank_mm**2 / (np.pi**2 * texture.height_mm)


def _check_resolved(texture: Texture, spacing_mm: float) -> None:
    least = LEAST_FEATURE_SAMPLES * spacing_mm
    width = 2.0 * texture.flank_mm
    if width < least:
        pitch = texture.pitch_mm * least / width
        raise DesignError(
            f"{texture.pattern} with a pitch of {texture.pitch_mm:g} mm have ridges {width:.2f} mm "
            f"wide; the distance is sampled every {spacing_mm:.2f} mm, which resolves {least:.2f} "
            "mm",
            hint=f"raise the pitch to {pitch:.2f} mm or lower contact.grid_mm",
            at="indenter.texture.pitch_mm",
        )


def _crest(away_mm: np.ndarray, flank_mm: float) -> np.ndarray:
    """Raised cosine: 1 on the crest, 0 from `flank_mm` on."""
    return np.cos(0.5 * np.pi * np.minimum(away_mm / flank_mm, 1.0)) ** 2


def _repeated(texture: Texture, place: np.ndarray) -> np.ndarray:
    """Heights of grid, dots and waves; a crest passes through the origin."""
    pitch = texture.pitch_mm
    off = np.abs(place - pitch * np.round(place / pitch))
    away = {
        Pattern.WAVES: off[:, 0],
        Pattern.GRID: off.min(axis=1),
        Pattern.DOTS: np.linalg.norm(off, axis=1),
    }[texture.pattern]
    return texture.height_mm * _crest(away, texture.flank_mm)


def _lettering(texture: Texture) -> np.ndarray:
    """Letters as shares of the height, shape (rows, columns)."""
    import cv2

    font = cv2.FONT_HERSHEY_SIMPLEX
    scale = LETTER_PIXELS / HERSHEY_CAPITAL
    (width, _), _ = cv2.getTextSize(texture.text, font, scale, 1)
    margin = LETTER_PIXELS // 2
    paper = np.full((LETTER_PIXELS + 2 * margin, width + 2 * margin), 255, np.uint8)
    cv2.putText(paper, texture.text, (margin, margin + LETTER_PIXELS), font, scale, 0, 1)
    away_mm = cv2.distanceTransform(paper, cv2.DIST_L2, cv2.DIST_MASK_PRECISE).astype(np.float64)
    away_mm *= texture.pitch_mm / LETTER_PIXELS
    return _crest(away_mm, texture.flank_mm)


def _image(texture: Texture, spacing_mm: float) -> Heights:
    from scipy.ndimage import gaussian_filter

    assert texture.image is not None
    pixel_mm = texture.pitch_mm / texture.image.heights.shape[1]
    sigma = FILTER_SAMPLES * spacing_mm / pixel_mm
    # Nothing stands outside the picture, and its rim must not be a cliff.
    padded = np.pad(texture.image.heights, int(np.ceil(3.0 * sigma)) + 1)
    smooth = gaussian_filter(padded, sigma)
    rise, run = np.gradient(smooth * texture.height_mm, pixel_mm)
    slope = float(np.hypot(rise, run).max())
    if slope > STEEPEST:
        raise DesignError(
            f"the texture image rises with a slope of {slope:.2f}; the limit is {STEEPEST:g}",
            hint=f"lower its height to {texture.height_mm * STEEPEST / slope:.3f} mm or blur it",
            at="indenter.texture.height_mm",
        )
    return _pixels(smooth, texture, pixel_mm)


def _pixels(shares: np.ndarray, texture: Texture, pixel_mm: float) -> Heights:
    """Heights between the pixels of a picture about the origin; 0 beside it.

    The camera looks along body +Z: with +Y upward, +X is then on its left.
    """
    from scipy.ndimage import map_coordinates

    rows, columns = shares.shape

    def field(place: np.ndarray) -> np.ndarray:
        row = 0.5 * (rows - 1) - place[:, 1] / pixel_mm
        column = 0.5 * (columns - 1) - place[:, 0] / pixel_mm
        found = map_coordinates(shares, [row, column], order=1, mode="constant", cval=0.0)
        return texture.height_mm * found

    return field
