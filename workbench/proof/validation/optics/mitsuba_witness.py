"""`workbench validate optics --reference mitsuba`: traced photons beside the renderer Mitsuba 3.

A matte finger with three wide LEDs, at index 1.41 and without refraction, at rest and with a dent,
is rendered by both (`mitsuba_images`) and compared in rings about the image's centre, in octants
and where the dent is. Nothing is fitted: power, areas and units are equal. Then the scenes of the
shipped record are rendered again (`mitsuba_again`).

Mitsuba's standard error is that of two halves with different seeds: a mean of N pixels a_i, b_i
has sqrt(sum (a_i - b_i)^2) / (2 N). A region counts where that is below 1 %; the others are stated.
"""

from __future__ import annotations

import importlib.util
import itertools

import numpy as np

from workbench.core.base.errors import DeviceError
from workbench.proof.row import Row, compared, failed, stated
from workbench.proof.validation.optics import mitsuba_again
from workbench.proof.validation.optics.mitsuba_images import (
    CAMERA,
    CASES,
    REMEDY,
    Case,
    Witness,
    witness,
)

LIMIT = 0.03
CONVERGED = 0.01
RINGS_PX = (0, 4, 8, 12, 16, 20, 24)
OCTANTS = 8


def rows() -> list[Row]:
    """All rows of the room."""
    from workbench.pipeline.devices import open_device

    if importlib.util.find_spec("mitsuba") is None:
        why = f"Mitsuba is not installed: {REMEDY}"
        return [failed("mitsuba", "the whole room", unit="1", why=why)]
    open_device()
    return [*(row for case in CASES for row in case_rows(case)), *mitsuba_again.rows()]


def case_rows(case: Case) -> list[Row]:
    """The rows of one scene."""
    try:
        seen = witness(case)
    except DeviceError as error:
        return [failed("mitsuba", case.name, unit="1", why=error.message)]
    found = [
        _row(case, f"ring {low} to {high} px", seen, inside)
        for (low, high), inside in zip(_pairs(RINGS_PX), rings(), strict=True)
    ]
    if case.dented:
        inside = np.repeat(seen.moved[:, :, None], 3, axis=2)
        found.append(_row(case, "where the dent is", seen, inside))
    if case.index != 1.0:
        found.append(_product(case, seen))
    return [*found, _octants(case, seen)]


def _row(case: Case, region: str, seen: Witness, inside: np.ndarray) -> Row:
    """Ratio of a region's light, beside the null; stated where Mitsuba has not converged."""
    error = standard_error(seen, inside)
    what = f"{case.name}, {region}; ceiling: Mitsuba's standard error; null: direct light alone"
    if case.index != 1.0:
        what += "; with mirror images in the wall, which the product leaves out"
    value, null = (ratio(image, seen.mitsuba, inside) for image in (seen.traced, seen.direct))
    if error >= CONVERGED:
        what += "; not converged"
        return stated("mitsuba", what, value, unit="1", null=null, ceiling=error)
    return compared("mitsuba", what, value, 1.0, unit="1", limit=LIMIT, null=null, ceiling=error)


def _product(case: Case, seen: Witness) -> Row:
    """What the product's images lack: their worst ring of those that converged."""
    found = [
        ratio(seen.product, seen.mitsuba, inside)
        for inside in rings()
        if standard_error(seen, inside) < CONVERGED
    ]
    what = f"{case.name}, worst ring without mirror images, as the product draws it"
    if not found:
        return failed("mitsuba_product", what, unit="1", why="no ring converged")
    value = max(found, key=lambda share: abs(share - 1.0))
    return stated("mitsuba_product", what, value, unit="1")


def _octants(case: Case, seen: Witness) -> Row:
    """The worst octant of those that converged."""
    regions = [inside for inside in octants() if standard_error(seen, inside) < CONVERGED]
    what = f"{case.name}, worst octant"
    if not regions:
        return failed("mitsuba_octant", what, unit="1", why="none converged")
    what += f"; {len(regions)} of {OCTANTS} converged; null: direct light alone"
    ratios = [ratio(seen.traced, seen.mitsuba, inside) for inside in regions]
    nulls = [ratio(seen.direct, seen.mitsuba, inside) for inside in regions]
    value, null = (max(found, key=lambda r: abs(r - 1.0)) for found in (ratios, nulls))
    return compared("mitsuba_octant", what, value, 1.0, unit="1", limit=LIMIT, null=null)


def ratio(image: np.ndarray, reference: np.ndarray, inside: np.ndarray) -> float:
    """Light of one image over that of another in a region (H, W, 3)."""
    return float(image[inside].sum(dtype=np.float64) / reference[inside].sum(dtype=np.float64))


def standard_error(seen: Witness, inside: np.ndarray) -> float:
    """Relative standard error [1] of Mitsuba's mean over a region (H, W, 3)."""
    spread = np.sqrt((seen.error[inside].astype(np.float64) ** 2).sum())
    return float(spread / seen.mitsuba[inside].sum(dtype=np.float64))


def rings() -> list[np.ndarray]:
    """Masks (H, W, 3) of the rings about the image's centre, whole ones only."""
    x, y = _from_centre()
    away = np.hypot(x, y)
    return [_all_colours((away >= low) & (away < high)) for low, high in _pairs(RINGS_PX)]


def octants() -> list[np.ndarray]:
    """Masks (H, W, 3) of the octants of the largest ring's disc."""
    x, y = _from_centre()
    around = np.floor((np.arctan2(y, x) / (2.0 * np.pi) + 0.5) * OCTANTS).astype(int) % OCTANTS
    inside = np.hypot(x, y) < RINGS_PX[-1]
    return [_all_colours((around == octant) & inside) for octant in range(OCTANTS)]


def _pairs(borders: tuple[int, ...]) -> list[tuple[int, int]]:
    return list(itertools.pairwise(borders))


def _from_centre() -> tuple[np.ndarray, np.ndarray]:
    rows_px, columns_px = np.mgrid[: CAMERA.height_px, : CAMERA.width_px]
    return columns_px + 0.5 - CAMERA.width_px / 2.0, rows_px + 0.5 - CAMERA.height_px / 2.0


def _all_colours(mask: np.ndarray) -> np.ndarray:
    return np.repeat(mask[:, :, None], 3, axis=2)
