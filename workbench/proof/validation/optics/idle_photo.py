"""The preset of the GelTip at rest beside the photograph of it: nothing is fitted in this row.

The preset states its exposure, so grey levels are compared as they are. Structure is what is left
of each colour without its fall-off from the middle: without the constant and the r^2 of its own
least-squares quadratic in x and y. Of the three correlations the least counts.
"""

from __future__ import annotations

import dataclasses
import functools
import tempfile
from pathlib import Path

import numpy as np

from workbench.calibration.stored import lit_studio
from workbench.core.base.monitor import silent
from workbench.core.design.design import SensorDesign
from workbench.core.press.press_case import PressCase
from workbench.pipeline.store import Store
from workbench.planning.plan import InlineRunner, evaluate, plan
from workbench.project.named_designs import load_design
from workbench.project.photos import shipped_photos
from workbench.proof.row import Row, bounded, stated

CASE = "geltip"
PHOTO = "geltip_idle_640x480.png"
LEAST_DB, LEAST_CORRELATION = 24.5, 0.6


def rows() -> list[Row]:
    """Errors of grey levels, beside what a quadratic of each colour would leave, and structure."""
    at_rest = functools.cache(lambda: rest_image(load_design(CASE)))
    photo = photograph()
    return [
        bounded(
            "idle_photo",
            f"{CASE}; null: the photograph's mean colour",
            lambda: likeness_dB(at_rest(), photo),
            unit="dB",
            limit=LEAST_DB,
            sense="min",
            null=likeness_dB(np.broadcast_to(photo.mean(axis=(0, 1)), photo.shape), photo),
        ),
        stated(
            "idle_photo",
            "a quadratic of each colour, fitted to the photograph: 18 numbers",
            likeness_dB(quadratic(photo), photo),
            unit="dB",
        ),
        bounded(
            "idle_photo_structure",
            f"{CASE}: least correlation of three colours without their radial parts; null: even",
            lambda: least_correlation(at_rest(), photo),
            unit="1",
            limit=LEAST_CORRELATION,
            sense="min",
            null=0.0,
        ),
    ]


def photograph() -> np.ndarray:
    """The photograph in grey levels, shape (H, W, 3), float64."""
    from sim.optics.raster.photo_file import read_rgb

    return 255.0 * read_rgb(shipped_photos()[PHOTO], at="optics.background").astype(np.float64)


def rest_image(design: SensorDesign) -> np.ndarray:
    """A design's image at rest in grey levels, shape (H, W, 3), uint8; no photograph is in it.

    Raises:
        WorkbenchError: From the stages, of a design that cannot be built or lit.
    """
    optics = dataclasses.replace(design.optics, background=None, unit=None)
    design = dataclasses.replace(design, optics=optics)
    with tempfile.TemporaryDirectory() as folder:
        store = Store(Path(folder))
        for _ in evaluate(design, PressCase(), InlineRunner(store), wanted=("mesh",)):
            pass
        mesh = store.load("mesh", plan(design, PressCase())["mesh"].key)
        studio = lit_studio(design, mesh, store, silent, CASE)
        return studio.imager.backdrop.background_rgb.reshape(*studio.imager.shape, 3)


def likeness_dB(image: np.ndarray, photo: np.ndarray) -> float:
    """Peak signal to noise ratio [dB] of an image against the photograph, (H, W, 3) both."""
    from sim.optics.studio.metrics import psnr_dB

    return psnr_dB(image, photo)


def quadratic(image: np.ndarray) -> np.ndarray:
    """The least-squares quadratic in x, y of each colour of an image, (H, W, 3)."""
    basis = _basis(*image.shape[:2])
    found, *_ = np.linalg.lstsq(basis, image.reshape(-1, 3), rcond=None)
    return (basis @ found).reshape(image.shape)


def least_correlation(image: np.ndarray, photo: np.ndarray) -> float:
    """The least of three correlations of two images without their radial parts, (H, W, 3) both."""
    ours, theirs = _unradial(image), _unradial(photo)
    return min(float(np.corrcoef(ours[:, c], theirs[:, c])[0, 1]) for c in range(3))


def _unradial(image: np.ndarray) -> np.ndarray:
    """Each colour without the constant and the r^2 of its quadratic, shape (H W, 3)."""
    basis = _basis(*image.shape[:2])
    colours = image.reshape(-1, 3).astype(np.float64)
    found, *_ = np.linalg.lstsq(basis, colours, rcond=None)
    curvature = (found[3] + found[4]) / 2.0
    square = basis[:, 3] + basis[:, 4]
    return colours - found[0] - square[:, None] * curvature


def _basis(rows: int, columns: int) -> np.ndarray:
    """1, x, y, x^2, y^2, x y of each pixel about the middle, in half widths, shape (H W, 6)."""
    row, column = np.mgrid[:rows, :columns]
    x = (2.0 * column.ravel() + 1.0 - columns) / columns
    y = (2.0 * row.ravel() + 1.0 - rows) / columns
    return np.stack([np.ones_like(x), x, y, x * x, y * y, x * y], axis=1)
