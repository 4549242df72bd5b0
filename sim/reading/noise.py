"""The noise of a difference of two photographs: its size, and how many pixels share it.

Noise of an image sensor is white, but light that was counted on the skin, a picture that was
compressed or scaled, and light that bounced otherwise are alike from pixel to pixel. Where n pixels
share their noise, the mean of N of them is off by sqrt(n / N) of what one is: a fit that takes them
for independent is too sure of itself by sqrt(n). n is the sum of the correlations of a pixel with
all others, found from the means of tiles.
Source: Bartlett, On the theoretical specification and sampling properties of autocorrelated
time-series, 1946, of the variance of a mean, in two dimensions.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

TILE_PX = 16
"""Edge of the tiles: noise that is alike farther than that counts as light that changed."""
QUIET = 0.5
"""Share of the tiles, the quietest, that show noise alone before it is known what changed."""
LEAST_GREY = 0.3
"""Of whole grey levels."""
WHOLE = 1.0 - 1e-4
"""Share of the pixels of a tile that count, of one all of whose pixels do."""
FEWEST = 12
"""Tiles from which it is told how many pixels share their noise."""
MOST_JUDGED = 20_000
"""Pixels from which its size is found, about: a hundredth of a grey level."""
OUTLYING = 4.0
"""Median sizes beyond which a difference is no noise."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Noise:
    """Of the pixels of a difference."""

    grey: float
    """Standard deviation of a pixel."""
    shared_px: float = 1.0
    """Pixels that share it, about; at least 1."""

    def of_block(self, pixels: np.ndarray) -> np.ndarray:
        """Variance of the mean of some pixels side by side [grey2], of the shape of their count."""
        count = np.maximum(pixels, 1.0)
        return self.grey**2 * np.minimum(self.shared_px, count) / count

    def of_many(self) -> float:
        """Variance of a pixel [grey2] by which many of them count as if they were independent."""
        return self.grey**2 * self.shared_px


def noise_of(difference: np.ndarray, calm: np.ndarray) -> Noise:
    """The noise where nothing changed.

    Args:
        difference: Without what changed all over [grey], shape (H, W, 3).
        calm: Pixels where nothing changed, shape (H, W), bool.
    """
    if not calm.any():
        return Noise(grey=LEAST_GREY)
    grey = max(LEAST_GREY, spread_grey(some_of(difference, calm)))
    whole = tile_means(calm) > WHOLE
    if np.count_nonzero(whole) < FEWEST:
        return Noise(grey=grey)
    means = tile_means(difference)[whole]
    shared_px = TILE_PX**2 * float((means**2).mean()) / grey**2
    return Noise(grey=grey, shared_px=max(1.0, shared_px))


def quiet_grey(difference: np.ndarray, sees: np.ndarray) -> float:
    """Standard deviation of a difference, (H, W, C), in the quietest tiles, before more is known.

    Args:
        difference: Shape (H, W, C).
        sees: Pixels that count, shape (H, W), bool.
    """
    whole = tile_means(sees) > WHOLE
    if np.count_nonzero(whole) < FEWEST:
        return float(np.sqrt(np.median(difference[sees] ** 2))) if sees.any() else 0.0
    square, mean = tile_means(difference**2)[whole], tile_means(difference)[whole]
    variance = (square - mean**2).max(axis=1)
    count = max(1, int(QUIET * len(variance)))
    return float(np.sqrt(max(0.0, np.partition(variance, count - 1)[:count].mean())))


def some_of(image: np.ndarray, chosen: np.ndarray) -> np.ndarray:
    """Some of the chosen pixels, evenly over them: about `MOST_JUDGED`, shape (n, 3).

    Args:
        image: Shape (H, W, 3).
        chosen: Shape (H, W), bool.
    """
    at = np.flatnonzero(chosen)
    return image.reshape(-1, image.shape[2])[at[:: max(1, len(at) // MOST_JUDGED)]]


def spread_grey(values: np.ndarray) -> float:
    """Standard deviation of noise (n, 3), in whole grey levels too, with outliers left out."""
    size = np.abs(values)
    plain = size <= OUTLYING * max(float(np.median(size)), 1.0)
    return float(np.sqrt((size[plain] ** 2).mean()))


def tile_means(image: np.ndarray) -> np.ndarray:
    """Means of an image, (H, W, ...), over whole tiles, shape (h, w, ...); none: empty."""
    import cv2

    rows, columns = (size // TILE_PX for size in image.shape[:2])
    if not rows or not columns:
        return np.empty((0, 0, *image.shape[2:]), np.float32)
    cut = image[: rows * TILE_PX, : columns * TILE_PX].astype(np.float32)
    return cv2.resize(cut, (columns, rows), interpolation=cv2.INTER_AREA)
