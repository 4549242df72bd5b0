"""What light leaves in each photograph, and how that changes with everything that is unknown.

Residuals are light times the slope of the display curve where the photograph is, so they count as
grey levels do. Values are, in this order: the unknowns, the depth of each press, the shift of each
circle along columns and along rows, and each power that is not 0.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sim.optics.raster.display import light_of
from workbench.calibration.gauss_newton import Rows, alike_samples, robust_shares
from workbench.calibration.light_basis import LightBasis, PressSamples
from workbench.calibration.powers import Powers, Targets, grey_per_light, photo_change
from workbench.calibration.seen.drift import CUT_OFF
from workbench.core.design.camera import ImageSensor

DIM = 10.0
"""Grey level below which a photograph is dark, where the camera sees no skin."""
OF_MEDIAN = 0.5
"""The image at rest counts no dark place more than one of this share of its median light."""
BLUR = 2.0
"""Standard deviation of the blur that photograph and prediction are compared with [sample]."""
PATCHES = 25
"""Independent residuals of an image at most: the light model errs over fifths of its sides."""
LEAST_GREY = 4.0
"""Error that is left at best [grey level]: that of the light model itself, against frames of a flat
pad by `photons` in the very same design, 3 to 6 in contacts and 3 at rest. A fit that leaves less
has taken the model's errors for something else."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Image:
    """The image at rest, or what a press changed, at samples on a regular grid."""

    light: np.ndarray
    """Shape (N, 3)."""
    weight: np.ndarray
    """Grey levels per light, 0 where nothing can be told, shape (N, 3)."""
    grid: tuple[int, int]
    """Rows and columns of the samples."""
    step_px: int
    """Pixels from sample to sample."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Slopes:
    """How light at the samples of all images changes with one unknown, powers fixed."""

    rest: np.ndarray
    """Shape (N, 3)."""
    presses: tuple[np.ndarray, ...]
    """(N, 3) each."""
    places_mm: np.ndarray
    """How the places on the skin where the circles are seen change, shape (J, 3)."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Whitening:
    """How much each residual counts."""

    rest: float
    """Standard deviation of what counts as one [grey level]."""
    press: float
    shares: tuple[np.ndarray, ...]
    """Of every residual's square, for what stands out, (N, 3) for each image."""

    def over(self, number: int) -> np.ndarray:
        """One over the deviations of an image's residuals, (N, 3); image 0 is at rest."""
        return np.sqrt(self.shares[number]) / (self.press if number else self.rest)


def images_of(
    targets: Targets, basis: LightBasis, sensor: ImageSensor, width_px: int
) -> tuple[Image, ...]:
    """The image at rest and the presses; dark places beside the skin count, where they are dark."""
    light = light_of(np.clip(targets.idle / 255.0, 0.0, 1.0), sensor)
    sees = basis.ambient[:, None] > 0.0
    usable = (targets.idle < CUT_OFF) & (sees | (targets.idle < DIM))
    at = np.maximum(light, OF_MEDIAN * np.median(light[sees[:, 0]]))
    weight = np.where(usable, grey_per_light(at, sensor), 0.0)
    grid, step = _grid(basis.rest_pixel, width_px)
    found = [Image(light=light, weight=weight, grid=grid, step_px=step)]
    for samples, (photo, idle) in zip(basis.presses, targets.presses, strict=True):
        change = photo_change(photo, idle, sensor)
        grid, step = _grid(samples.pixel, width_px)
        found.append(Image(light=change.light, weight=change.weight, grid=grid, step_px=step))
    return tuple(found)


def _grid(pixel: np.ndarray, width_px: int) -> tuple[tuple[int, int], int]:
    columns = np.unique(pixel % width_px)
    step = int(columns[1] - columns[0]) if len(columns) > 1 else 1
    return (len(np.unique(pixel // width_px)), len(columns)), step


def residuals(images: Sequence[Image], basis: LightBasis, powers: Powers) -> list[np.ndarray]:
    """What is left of each image [grey level], (N, 3) each."""
    rest, *presses = images
    predicted = basis.rest @ powers.lights.T + basis.ambient[:, None] * powers.ambient
    left = [(predicted - rest.light) * rest.weight]
    for image, samples, depth in zip(presses, basis.presses, powers.depths_mm, strict=True):
        left.append((samples.at(depth) @ powers.lights.T - image.light) * image.weight)
    return left


def press_error(images: Sequence[Image], basis: LightBasis, powers: Powers) -> float:
    """Root mean square of what is left in the presses [grey level]."""
    left = residuals(images, basis, powers)[1:]
    count = sum(int((image.weight > 0.0).sum()) for image in images[1:])
    return float(np.sqrt(sum(float((each**2).sum()) for each in left) / max(count, 1)))


def whitening(images: Sequence[Image], left: Sequence[np.ndarray]) -> Whitening:
    """Deviations with which residuals count as many as are independent.

    What light leaves is mostly the light model's own error, smooth and in part taken up by what is
    fitted, so an image has no more than `PATCHES` independent ones. In presses it is common to all:
    many photographs do not make it less, and all of them together count as one.
    """
    shares = [robust_shares(each) for each in left]
    robust = [
        (blurred(np.sqrt(share) * each, image.grid), image.grid)
        for share, each, image in zip(shares, left, images, strict=True)
    ]
    sizes = [image.grid[0] * image.grid[1] / PATCHES for image in images]
    alike = (
        max(alike_samples(robust[:1]), sizes[0]),
        len(images[1:]) * max(alike_samples(robust[1:]), float(np.mean(sizes[1:]))),
    )
    squares = [float((each**2).sum()) for each, _ in robust]
    counts = [float((image.weight > 0.0).sum()) for image in images]
    rest = squares[0] / max(counts[0], 1.0)
    press = sum(squares[1:]) / max(sum(counts[1:]), 1.0)
    one, other = (
        float(np.sqrt(max(square, LEAST_GREY**2) * area))
        for square, area in zip((rest, press), alike, strict=True)
    )
    return Whitening(rest=one, press=other, shares=tuple(shares))


def misfit(images: Sequence[Image], left: Sequence[np.ndarray], over: Whitening) -> float:
    """Sum of the squares over their variances."""
    return sum(
        float((blurred(each * over.over(k), image.grid) ** 2).sum())
        for k, (image, each) in enumerate(zip(images, left, strict=True))
    )


def blurred(values: np.ndarray, grid: tuple[int, int]) -> np.ndarray:
    """Columns (N, K) of samples on a grid as they are compared: the finest patterns are left out.

    They are those of photons and of the mesh's triangles, in derivatives too, where they would pass
    for something that the photographs tell.
    """
    from scipy.ndimage import gaussian_filter1d

    image = values.reshape(*grid, -1)
    for axis in (0, 1):
        image = gaussian_filter1d(image, BLUR, axis=axis, mode="nearest")
    return image.reshape(values.shape)


def active_powers(powers: Powers) -> np.ndarray:
    """Colour and light of each power that is not 0, shape (P, 2); ambient light is light L."""
    whole = np.column_stack([powers.lights, powers.ambient])
    return np.argwhere(whole > 0.0)


def image_rows(
    images: Sequence[Image],
    fit: tuple[LightBasis, Powers],
    slopes: Sequence[Slopes],
    over: Whitening,
) -> list[Rows]:
    """Residuals of all images over their standard deviations, with all derivatives."""
    basis, powers = fit
    left = residuals(images, basis, powers)
    count, presses = len(slopes), len(basis.presses)
    active = active_powers(powers)
    first_power = count + 3 * presses
    unknown = np.arange(count)
    rest = images[0]
    found = []
    whole = np.column_stack([basis.rest, basis.ambient])
    for colour in range(3):
        mine = np.flatnonzero(active[:, 0] == colour)
        by_unknown = [each.rest[:, colour] for each in slopes]
        slope = np.column_stack([*by_unknown, whole[:, active[mine, 1]]])
        share = over.over(0)[:, colour]
        slope = slope * (rest.weight[:, colour] * share)[:, None]
        value = np.concatenate([unknown, first_power + mine])
        found.append(_rows(left[0][:, colour] * share, slope, value, rest.grid))
    for number, (image, samples) in enumerate(zip(images[1:], basis.presses, strict=True)):
        depth = powers.depths_mm[number]
        lights = samples.at(depth)
        deeper = _by_depth(samples, depth) @ powers.lights.T
        right, down = _moved(lights @ powers.lights.T, image)
        own = count + number + presses * np.arange(3)
        for colour in range(3):
            mine = np.flatnonzero((active[:, 0] == colour) & (active[:, 1] < len(basis.lights)))
            by_unknown = [each.presses[number][:, colour] for each in slopes]
            columns = [*by_unknown, deeper[:, colour], right[:, colour], down[:, colour]]
            slope = np.column_stack([*columns, lights[:, active[mine, 1]]])
            share = over.over(number + 1)[:, colour]
            slope = slope * (image.weight[:, colour] * share)[:, None]
            value = np.concatenate([unknown, own, first_power + mine])
            residual = left[number + 1][:, colour] * share
            found.append(_rows(residual, slope, value, image.grid))
    return found


def _rows(
    residual: np.ndarray, slope: np.ndarray, value: np.ndarray, grid: tuple[int, int]
) -> Rows:
    whole = blurred(np.column_stack([residual, slope]), grid)
    return Rows(residual=whole[:, 0], slope=whole[:, 1:], value=value)


def _by_depth(samples: PressSamples, depth_mm: float) -> np.ndarray:
    """Change of light per mm of depth, shape (N, L); 0 of a depth that is known."""
    depths = samples.depths_mm
    if len(depths) == 1:
        return np.zeros_like(samples.change[0])
    low = min(max(int(np.searchsorted(depths, depth_mm)) - 1, 0), len(depths) - 2)
    span_mm = np.float32(depths[low + 1] - depths[low])
    return (samples.change[low + 1] - samples.change[low]) / span_mm


def _moved(light: np.ndarray, image: Image) -> tuple[np.ndarray, np.ndarray]:
    """Change of light (N, 3) per pixel that a contact moves along columns and along rows."""
    drawn = light.reshape(*image.grid, 3)
    found = []
    for axis in (1, 0):
        wide = image.grid[axis] > 1
        slope = np.gradient(drawn, image.step_px, axis=axis) if wide else np.zeros_like(drawn)
        found.append(-np.asarray(slope).reshape(light.shape))
    return found[0], found[1]
