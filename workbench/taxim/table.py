"""The table of Taxim: the change of colour by the slope of the skin, a quadratic over the image.

A slope has a size arctan |grad h| in [0, pi / 2] and a direction atan2(dh/dv, dh/du) in [-pi, pi];
each is divided into 125 bins. A bin holds, per colour, a to f of

    a u^2 + b v^2 + c u v + d u + e v + f,

what it adds to the image at rest in pixel (u, v). h is the height toward the camera in pixels.
Source: Si, Yuan, Taxim: an example-based simulation model for GelSight tactile sensors, RA-L 2022,
and its program (`Calibration/polyTableCalib.py`, `OpticalSimulation/simOptical.py`).

Here a bin is fitted by least squares to all pixels whose slopes lie around it: the widest
neighbourhood is taken that has `ENOUGH` pixels, by Gaussian weights over bins, so that a bin that
no dent shows goes on as those beside it.
"""

from __future__ import annotations

import numpy as np

BINS = 125
STEP_SIZE, STEP_DIRECTION = 0.5 * np.pi / (BINS - 1), 2.0 * np.pi / (BINS - 1)
"""Width of a bin [rad]."""
TERMS = 6
ENOUGH = 400
SPREADS = (1.0, 2.0, 4.0, 8.0, 16.0, 32.0)
"""Standard deviations of the weights that are tried [bins]."""
RIDGE = 1e-3
"""Pull of all terms but the last toward 0, as a share of the pixels that count."""
UPPER = np.triu_indices(TERMS)


def slopes(height_px: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """dh/du and dh/dv by central differences, both (H, W), as Taxim takes them.

    Args:
        height_px: Height toward the camera in pixels, shape (H, W).
    """
    across = (height_px[1:-1, 2:] - height_px[1:-1, :-2]) / 2.0
    down = (height_px[2:, 1:-1] - height_px[:-2, 1:-1]) / 2.0
    return np.pad(across, 1, mode="symmetric"), np.pad(down, 1, mode="symmetric")


def bins_of(across: np.ndarray, down: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Bins of size and direction of slopes, any shape."""
    size = np.arctan(np.hypot(across, down))
    direction = np.where(size > 0.0, np.arctan2(down, across), 0.0)
    last = BINS - 1
    return (
        np.clip(np.floor(size / STEP_SIZE).astype(int), 0, last),
        np.clip(np.floor((direction + np.pi) / STEP_DIRECTION).astype(int), 0, last),
    )


def looked_up(table: np.ndarray, height_px: np.ndarray) -> np.ndarray:
    """What a table adds to the image at rest, shape (H, W, 3), as Taxim's program does it.

    Args:
        table: Shape (125, 125, 6, 3).
        height_px: Height toward the camera in pixels, shape (H, W).
    """
    rows, columns = height_px.shape
    v, u = np.mgrid[:rows, :columns].astype(float)
    terms = np.stack([u * u, v * v, u * v, u, v, np.ones_like(u)], axis=-1)
    return np.einsum("hwt,hwtc->hwc", terms, table[bins_of(*slopes(height_px))])


class TableFit:
    """Pixels of dents as they come, and the table that fits them best."""

    def __init__(self, rows: int, columns: int) -> None:
        v, u = np.mgrid[:rows, :columns].astype(float)
        self._scale = (2.0 / columns, 2.0 / rows)
        u, v = u * self._scale[0] - 1.0, v * self._scale[1] - 1.0
        self._terms = np.stack([u * u, v * v, u * v, u, v, np.ones_like(u)], axis=-1)
        self._sums = np.zeros((BINS * BINS, len(UPPER[0]) + 3 * TERMS))
        self._rest = np.zeros((TERMS, 3))
        self._count = np.zeros(BINS * BINS)

    def rest(self, change: np.ndarray, chosen: np.ndarray) -> None:
        """What is added where nothing is touched: (H, W, 3) at the chosen pixels, (H, W)."""
        self._rest = np.linalg.lstsq(self._terms[chosen], change[chosen], rcond=None)[0]

    def add(self, height_px: np.ndarray, change: np.ndarray, chosen: np.ndarray) -> None:
        """An image of a dent.

        Args:
            height_px: Height toward the camera in pixels, shape (H, W).
            change: Image less the image at rest [grey values], shape (H, W, 3).
            chosen: Pixels that count, shape (H, W), bool.
        """
        from scipy.sparse import csr_array

        size, direction = bins_of(*(part[chosen] for part in slopes(height_px)))
        terms, change = self._terms[chosen], change[chosen]
        pairs = terms[:, UPPER[0]] * terms[:, UPPER[1]]
        sides = (terms[:, :, None] * change[:, None, :]).reshape(len(terms), -1)
        ones = np.ones(len(terms))
        where = (size * BINS + direction, np.arange(len(terms)))
        sums = csr_array((ones, where), shape=(BINS * BINS, len(terms)))
        self._sums += sums @ np.concatenate([pairs, sides], axis=1)
        self._count += sums @ ones

    def table(self) -> np.ndarray:
        """The table, shape (125, 125, 6, 3), float64; slopes of no size add what `rest` says."""
        sums = self._sums.reshape(BINS, BINS, -1)
        count = self._count.reshape(BINS, BINS)
        found = np.zeros((BINS, BINS, TERMS, 3))
        todo = np.ones((BINS, BINS), dtype=bool)
        for spread in SPREADS:
            weight = 2.0 * np.pi * spread**2
            pixels = weight * _blurred(count, spread)
            ready = todo & ((pixels >= ENOUGH) | (spread == SPREADS[-1]))
            found[ready] = _solved(weight * _blurred(sums, spread)[ready], pixels[ready])
            todo &= ~ready
        found[0] = self._rest
        return np.einsum("st,abtc->absc", self._of_pixels(), found)

    def _of_pixels(self) -> np.ndarray:
        """Terms of scaled places, x = a u - 1 and y = b v - 1, by those of pixels, shape (6, 6)."""
        a, b = self._scale
        columns = [
            (a * a, 0.0, 0.0, -2.0 * a, 0.0, 1.0),
            (0.0, b * b, 0.0, 0.0, -2.0 * b, 1.0),
            (0.0, 0.0, a * b, -a, -b, 1.0),
            (0.0, 0.0, 0.0, a, 0.0, -1.0),
            (0.0, 0.0, 0.0, 0.0, b, -1.0),
            (0.0, 0.0, 0.0, 0.0, 0.0, 1.0),
        ]
        return np.array(columns).T


def _blurred(values: np.ndarray, spread: float) -> np.ndarray:
    """Gaussian means over sizes and, all around, directions: both (125, 125, ...)."""
    from scipy.ndimage import gaussian_filter1d

    over_sizes = gaussian_filter1d(values, spread, axis=0, mode="nearest")
    return gaussian_filter1d(over_sizes, spread, axis=1, mode="wrap")


def _solved(sums: np.ndarray, pixels: np.ndarray) -> np.ndarray:
    """Terms of some bins, shape (n, 6, 3), from their sums, (n, 39), and pixels, (n,)."""
    matrix = np.zeros((len(sums), TERMS, TERMS))
    matrix[:, UPPER[0], UPPER[1]] = sums[:, : len(UPPER[0])]
    matrix[:, UPPER[1], UPPER[0]] = sums[:, : len(UPPER[0])]
    pull = RIDGE * np.append(np.ones(TERMS - 1), 1e-3)
    matrix += np.maximum(pixels, 1.0)[:, None, None] * np.diag(pull)
    return np.linalg.solve(matrix, sums[:, len(UPPER[0]) :].reshape(-1, TERMS, 3))
