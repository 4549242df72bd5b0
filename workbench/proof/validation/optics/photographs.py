"""Presets at rest beside the photographs of such sensors that ship.

The GelTip's preset was fitted to its photograph, so its grey levels are compared as they are:
`idle_photo`. Besides, the colours must not be those of another light: each colour's share
of all light in the image over that in the photograph.

Of the elephant's trunk there are two photographs of prototypes whose LEDs, lenses and exposures
nobody wrote down: in one all light is blue, in the other red is missing. Grey levels say nothing
there, and any image that is bright in the middle is like them: a finger's correlates by .5. What
only a trunk shows is what is not round, the oval rim and the band of light along the saddle. So the
mean over each circle about the middle is taken away from the luminance, within the largest circle
of the image, and the rest is correlated; of a finger it is -.05. One number is fitted: the lens,
whose angle makes the rim about as wide as in the photographs. Null: the image turned by 90 degrees.
"""

from __future__ import annotations

import functools
from collections.abc import Callable

import numpy as np

from workbench.project.named_designs import load_design
from workbench.project.photos import shipped_photos
from workbench.proof.row import Row, bounded
from workbench.proof.validation.optics import idle_photo

TRUNK_PHOTOS = ("elephant_bkg_640_480_real.png", "elephant_bkg_640_480_1_real.png")
TRUNK_FOV_DEG = 76.0
TRUNK_LEAST = 0.4
PHOTONS = 1_000_000
BALANCE_LIMIT = 0.03


def rows() -> list[Row]:
    """Those of the GelTip, then two of the trunk."""
    return [*idle_photo.rows(), _balance(), *_trunk_rows()]


def _balance() -> Row:
    shown = functools.cache(lambda: idle_photo.rest_image(load_design(idle_photo.CASE)))
    photo = idle_photo.photograph()
    grey = np.ones_like(photo)
    return bounded(
        "idle_photo_balance",
        f"{idle_photo.CASE}: a colour's share of all light over that in the photograph, largest "
        "error of three; null: grey light",
        lambda: balance_error(shown(), photo),
        unit="1",
        limit=BALANCE_LIMIT,
        null=balance_error(grey, photo),
    )


def _trunk_rows() -> list[Row]:
    shown = functools.cache(trunk_image)
    return [_trunk_row(name, shown) for name in TRUNK_PHOTOS]


def _trunk_row(name: str, shown: Callable[[], np.ndarray]) -> Row:
    photo = shipped_grey(name)
    return bounded(
        "idle_photo_oval",
        f"trunk through a lens of {TRUNK_FOV_DEG:g} degrees beside {name}: correlation of what is "
        "not round; null: turned by 90 degrees",
        lambda: oval_likeness(shown(), photo),
        unit="1",
        limit=TRUNK_LEAST,
        sense="min",
        null=lambda: oval_likeness(quarter_turned(shown()), photo),
    )


def trunk_image() -> np.ndarray:
    """The trunk's preset at rest as large as the photographs, grey levels (H, W, 3).

    Raises:
        WorkbenchError: From the stages.
    """
    design = load_design("trunk").replace("optics.baking.photons", PHOTONS)
    height, width = shipped_grey(TRUNK_PHOTOS[0]).shape[:2]
    camera = {"width_px": width, "height_px": height, "fov_x_deg": TRUNK_FOV_DEG}
    for name, value in camera.items():
        design = design.replace(f"optics.camera.{name}", value)
    return idle_photo.rest_image(design)


def shipped_grey(name: str) -> np.ndarray:
    """A shipped photograph in grey levels, shape (H, W, 3), float64."""
    from sim.optics.raster.photo_file import read_rgb

    return 255.0 * read_rgb(shipped_photos()[name], at="optics.background").astype(np.float64)


def balance_error(image: np.ndarray, photo: np.ndarray) -> float:
    """Largest relative error [1] of a colour's share of all grey levels, (H, W, 3) both."""
    ours, theirs = (one.mean(axis=(0, 1)) / one.mean() for one in (image, photo))
    return float(np.abs(ours / theirs - 1.0).max())


def oval_likeness(image: np.ndarray, photo: np.ndarray) -> float:
    """Correlation of two luminances without their means over circles, (H, W, 3) both."""
    return float(np.corrcoef(_not_round(image), _not_round(photo))[0, 1])


def quarter_turned(image: np.ndarray) -> np.ndarray:
    """The image's middle square turned by 90 degrees, the rest as it was, (H, W, 3)."""
    height, width = image.shape[:2]
    left, found = (width - height) // 2, image.copy()
    found[:, left : left + height] = np.rot90(image[:, left : left + height])
    return found


def _not_round(image: np.ndarray) -> np.ndarray:
    """Luminance less its mean over each circle of a pixel's width, within the image's height."""
    height, width = image.shape[:2]
    row, column = np.mgrid[:height, :width]
    away = np.hypot(row + 0.5 - height / 2.0, column + 0.5 - width / 2.0)
    inside = away < height / 2.0
    luminance, circle = image.mean(axis=2)[inside], away[inside].astype(int)
    mean = np.bincount(circle, luminance) / np.maximum(np.bincount(circle), 1)
    return luminance - mean[circle]
