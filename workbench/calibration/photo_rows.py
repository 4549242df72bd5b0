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
from workbench.calibration.drift import CUT_OFF
from workbench.calibration.gauss_newton import Rows, alike_samples
from workbench.calibration.light_basis import LightBasis, PressSamples
from workbench.calibration.powers import Powers, Targets, grey_per_light, photo_change
from workbench.core.design.camera import ImageSensor

DIM = 10.0
"""Grey level below which a photograph is dark, where the camera sees no skin."""
OF_MEDIAN = 0.5
"""The image at rest counts no dark place more than one of this share of its median light."""
LEAST_GREY = 0.7
"""Error that is left at best: rounding of two photographs and their noise [grey level]."""


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


@dataclass(frozen=True, kw_only=True, slots=True)
class Whitening:
    """What an independent residual's standard deviation is [grey level]."""

    rest: float
    press: float


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


def whitening(images: Sequence[Image], left: Sequence[np.ndarray]) -> Whitening:
    """Standard deviations that count as many residuals as are independent.

    Of N alike over A samples, N / A are; each then counts 1 / A of its square.
    """
    alike = [
        float(np.median([alike_samples(each[:, c].reshape(image.grid)) for c in range(3)]))
        for image, each in zip(images, left, strict=True)
    ]
    errors = [
        float((each**2).sum() / max((image.weight > 0.0).sum(), 1))
        for image, each in zip(images, left, strict=True)
    ]
    rest = max(errors[0], LEAST_GREY**2) * alike[0]
    press = max(float(np.mean(errors[1:])), LEAST_GREY**2) * float(np.median(alike[1:]))
    return Whitening(rest=float(np.sqrt(rest)), press=float(np.sqrt(press)))


def misfit(left: Sequence[np.ndarray], over: Whitening) -> float:
    """Sum of the squares over their variances."""
    rest, *presses = left
    whole = float((rest**2).sum()) / over.rest**2
    return whole + sum(float((each**2).sum()) for each in presses) / over.press**2


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
        by_unknown = np.array([each.rest[:, colour] for each in slopes]).reshape(count, -1).T
        slope = np.hstack([by_unknown, whole[:, active[mine, 1]]])
        slope = slope * rest.weight[:, colour, None] / over.rest
        value = np.concatenate([unknown, first_power + mine])
        found.append(Rows(residual=left[0][:, colour] / over.rest, slope=slope, value=value))
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
            slope = slope * image.weight[:, colour, None] / over.press
            value = np.concatenate([unknown, own, first_power + mine])
            residual = left[number + 1][:, colour] / over.press
            found.append(Rows(residual=residual, slope=slope, value=value))
    return found


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
