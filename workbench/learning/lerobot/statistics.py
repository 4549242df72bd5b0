"""Statistics by which learners scale what they read: of an episode, and of all.

Per number: least, largest, mean, standard deviation, five quantiles, and how many frames. Images
count per colour, over all pixels, from 0 to 1; as grey values are whole, a histogram of 256 knows
all of it exactly.
"""

from __future__ import annotations

import numpy as np

QUANTILES = {"q01": 0.01, "q10": 0.10, "q50": 0.50, "q90": 0.90, "q99": 0.99}
"""Those of LeRobot."""
GREYS = np.arange(256) / 255.0
Statistics = dict[str, np.ndarray]


def of_values(values: np.ndarray) -> Statistics:
    """Statistics of frames of numbers, shape (K, n); each has shape (n,), the count (1,)."""
    quantiles = np.quantile(values, list(QUANTILES.values()), axis=0)
    return {
        "min": values.min(axis=0),
        "max": values.max(axis=0),
        "mean": values.mean(axis=0, dtype=np.float64),
        "std": values.std(axis=0, dtype=np.float64),
        "count": np.array([len(values)]),
        **dict(zip(QUANTILES, quantiles, strict=True)),
    }


def histogram(image: np.ndarray) -> np.ndarray:
    """Pixels of each grey value, per colour, shape (3, 256), of an image, (H, W, 3), uint8."""
    return np.stack([np.bincount(image[..., c].ravel(), minlength=256) for c in range(3)])


def of_histogram(pixels: np.ndarray, frames: int) -> Statistics:
    """Statistics of so many images; each has shape (3, 1, 1), the count (1,).

    Args:
        pixels: The sum of their histograms, shape (3, 256).
        frames: How many images.
    """
    upto, total = np.cumsum(pixels, axis=1), pixels.sum(axis=1, keepdims=True)
    shares = pixels / total
    mean = shares @ GREYS
    there = pixels > 0
    found = {
        "min": GREYS[there.argmax(axis=1)],
        "max": GREYS[255 - there[:, ::-1].argmax(axis=1)],
        "mean": mean,
        "std": np.sqrt(np.maximum(shares @ GREYS**2 - mean**2, 0.0)),
        **{name: GREYS[(upto < share * total).sum(axis=1)] for name, share in QUANTILES.items()},
    }
    return {
        **{name: value.reshape(3, 1, 1) for name, value in found.items()},
        "count": np.array([frames]),
    }
