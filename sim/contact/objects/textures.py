"""Height fields of textures, and the signed function of a textured body.

The lower surface is moved along -Z by the height h(x, y): the function of the textured body at a
place is that of the smooth body at (x, y, z + h s), where s is 1 below the body origin and falls
to 0 at the top, so that sides stay upright and edges rounded. The function is a distance no
more, which `redistance` cures.
Letters are drawn by OpenCV (Hershey's strokes) once, and their flanks by the distance to a stroke.

What is too fine for the samples of a distance is left to the image (`fine_surface`,
`sim.optics.studio.detail`): contact then feels repeated patterns as a layer of their mean height,
letters and pictures through a Gaussian filter.
Left out: the displacement is along Z also where the smooth surface is steep.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from workbench.core.base.errors import DesignError
from workbench.core.press.texture import STEEPEST, Pattern, Texture

Heights = Callable[[np.ndarray], np.ndarray]
"""Heights [mm], shape (N,), at body places (N, 2)."""

LEAST_FEATURE_SAMPLES = 4.0
"""Width of the narrowest ridge in distance samples: fewer, and crests are lost."""
FINEST_MM = 0.05
"""Width of the narrowest ridge that an image shows [mm]: two pixels of a camera with 640 of them
that sees 16 mm of skin, as flat sensors have it."""
LETTER_PIXELS = 40
"""Pixels of a capital's height; heights between pixels are linear."""
FINE_LETTER_PIXELS = 160
"""The same for images, where the steps of a slanting stroke would show."""
PIXEL_BLUR = 0.7
"""Standard deviation of the blur of a picture in its own pixels; the edges of squares are gone."""
MOST_PIXELS = 4_000_000
"""Of a picture that is made finer: 32 MB."""
MEAN_PLACES = 64
"""Places per pitch and direction at which the mean height of a pattern is taken."""
HERSHEY_CAPITAL = 20.2
"""Height of a capital of OpenCV's simplex font in pixels at scale 1, as drawn."""
FILTER_SAMPLES = 1.5
"""Standard deviation of the filter that takes too fine detail out of an image, in samples."""


def heights(texture: Texture, spacing_mm: float) -> Heights:
    """The height field of a texture as a distance that is sampled at `spacing_mm` holds it.

    Raises:
        DesignError: If its ridges are too narrow even for an image, or a picture is too steep.
    """
    _check_fine(texture)
    if texture.pattern is Pattern.IMAGE:
        return _image(texture, spacing_mm)
    lettered, fine = texture.pattern is Pattern.LETTERS, not resolved(texture, spacing_mm)
    if lettered:
        pixel_mm = texture.pitch_mm / LETTER_PIXELS
        shares = _lettering(texture, LETTER_PIXELS)
        if fine:
            shares = _filtered(shares, filter_mm(texture, spacing_mm) / pixel_mm)
        return _pixels(shares, texture, pixel_mm)
    if fine:
        mean_mm = _mean_mm(texture)
        return lambda place: np.full(len(place), mean_mm)
    return lambda place: _repeated(texture, place)


def true_heights(texture: Texture) -> Heights:
    """The height field as the object has it, whatever contact can resolve.

    A picture's steps are blurred until they rise with `STEEPEST`: a skin follows no steeper ones.

    Raises:
        DesignError: If its ridges are too narrow for an image.
    """
    _check_fine(texture)
    if texture.pattern is Pattern.LETTERS:
        shares = _lettering(texture, FINE_LETTER_PIXELS)
        return _pixels(shares, texture, texture.pitch_mm / FINE_LETTER_PIXELS)
    if texture.pattern is Pattern.IMAGE:
        assert texture.image is not None
        pixel_mm = texture.pitch_mm / texture.image.heights.shape[1]
        step_mm = texture.height_mm / (STEEPEST * np.sqrt(2.0 * np.pi))
        # The picture's own pixels must not show as steps.
        sigma_mm = max(step_mm, 0.5 * FINEST_MM, PIXEL_BLUR * pixel_mm)
        most = int((MOST_PIXELS / texture.image.heights.size) ** 0.5)
        finer = max(1, min(int(np.ceil(2.0 * pixel_mm / sigma_mm)), most))
        shares = np.kron(texture.image.heights, np.ones((finer, finer)))
        pixel_mm /= finer
        return _pixels(_filtered(shares, sigma_mm / pixel_mm), texture, pixel_mm)
    return lambda place: _repeated(texture, place)


def resolved(texture: Texture, spacing_mm: float) -> bool:
    """Whether samples of a distance hold the ridges of a pattern; pictures are filtered instead."""
    return 2.0 * texture.flank_mm >= LEAST_FEATURE_SAMPLES * spacing_mm


def filter_mm(texture: Texture, spacing_mm: float) -> float:
    """Standard deviation [mm] of the filter between texture and contact.

    0 where the samples hold it; infinite where contact feels the mean height alone.
    """
    if texture.pattern is not Pattern.IMAGE and resolved(texture, spacing_mm):
        return 0.0
    if texture.pattern in (Pattern.IMAGE, Pattern.LETTERS):
        return FILTER_SAMPLES * spacing_mm
    return float("inf")


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


def sharpest_mm(texture: Texture, spacing_mm: float = 0.0) -> float:
    """Least radius of curvature of a crest [mm] that samples at `spacing_mm` hold.

    Infinite for none, for an image and for what is too fine for the samples.
    """
    if not texture.raised or not texture.height_mm or not resolved(texture, spacing_mm):
        return float("inf")
    return 2.0 * texture.flank_mm**2 / (np.pi**2 * texture.height_mm)


def _check_fine(texture: Texture) -> None:
    width = 2.0 * texture.flank_mm
    if width < FINEST_MM:
        pitch = texture.pitch_mm * FINEST_MM / width
        raise DesignError(
            f"{texture.pattern} with a pitch of {texture.pitch_mm:g} mm have ridges {width:.3f} mm "
            f"wide; neither contact nor image shows less than {FINEST_MM:g} mm",
            hint=f"raise the pitch to {pitch:.2f} mm",
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


def _mean_mm(texture: Texture) -> float:
    """Mean height of a repeated pattern."""
    line = texture.pitch_mm * (np.arange(MEAN_PLACES) + 0.5) / MEAN_PLACES
    x, y = np.meshgrid(line, line)
    return float(_repeated(texture, np.column_stack([x.ravel(), y.ravel()])).mean())


def _lettering(texture: Texture, pixels: int) -> np.ndarray:
    """Letters, a capital `pixels` high, as shares of the height, shape (rows, columns)."""
    import cv2

    font = cv2.FONT_HERSHEY_SIMPLEX
    scale = pixels / HERSHEY_CAPITAL
    (width, _), _ = cv2.getTextSize(texture.text, font, scale, 1)
    margin = pixels // 2
    paper = np.full((pixels + 2 * margin, width + 2 * margin), 255, np.uint8)
    cv2.putText(paper, texture.text, (margin, margin + pixels), font, scale, 0, 1)
    away_mm = cv2.distanceTransform(paper, cv2.DIST_L2, cv2.DIST_MASK_PRECISE).astype(np.float64)
    away_mm *= texture.pitch_mm / pixels
    return _crest(away_mm, texture.flank_mm)


def _image(texture: Texture, spacing_mm: float) -> Heights:
    assert texture.image is not None
    pixel_mm = texture.pitch_mm / texture.image.heights.shape[1]
    smooth = _filtered(texture.image.heights, FILTER_SAMPLES * spacing_mm / pixel_mm)
    rise, run = np.gradient(smooth * texture.height_mm, pixel_mm)
    slope = float(np.hypot(rise, run).max())
    if slope > STEEPEST:
        raise DesignError(
            f"the texture image rises with a slope of {slope:.2f}; the limit is {STEEPEST:g}",
            hint=f"lower its height to {texture.height_mm * STEEPEST / slope:.3f} mm or blur it",
            at="indenter.texture.height_mm",
        )
    return _pixels(smooth, texture, pixel_mm)


def _filtered(shares: np.ndarray, sigma: float) -> np.ndarray:
    """Shares through a Gaussian filter of `sigma` pixels, padded."""
    from scipy.ndimage import gaussian_filter

    # Nothing stands outside the picture, and its rim must not be a cliff.
    return gaussian_filter(np.pad(shares, int(np.ceil(3.0 * sigma)) + 1), sigma)


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
