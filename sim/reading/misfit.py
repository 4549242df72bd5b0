"""Draws of what blocks of pixels are off by: noise, and light that is not the sensor's.

Noise is as large and as alike from pixel to pixel as where nothing changed (`noise`). Light that is
off shows as residuals that noise does not explain. They are smooth, and the fit has already taken
from them what a displacement can imitate: one of three colours, about, so that half as much again
is drawn, alike over some blocks, and as large in each place as what was left around it.
"""

from __future__ import annotations

import numpy as np

from sim.reading.deviation import DRAWS
from sim.reading.noise import Noise

TAKEN = 1.5
"""Variance of an error of light over what a fit leaves of it."""
ALIKE = 2.0
"""Blur of such an error [blocks]."""
DOUBT = 5.0
"""Standard deviation of what the light makes of a change, over how far the light at rest is off:
lamps in another place shine from another side, which the photograph at rest shows but little."""
WIDE = 8.0
"""Blur of such an error [blocks]: a dent is read too deep or too shallow as a whole."""
AROUND = 3.0
"""Blur of its variance [blocks]."""
SEED = 2


class BlockGrid:
    """Places of P blocks in the image."""

    def __init__(self, rows: np.ndarray, columns: np.ndarray, edge_px: int) -> None:
        """Keep rows and columns, (P,) each, counted in blocks of an edge [px]."""
        first = rows.min(initial=0), columns.min(initial=0)
        if len(rows):
            first = int(rows.min()), int(columns.min())
        self._rows, self._columns = rows - first[0], columns - first[1]
        self._shape = int(self._rows.max(initial=0)) + 1, int(self._columns.max(initial=0)) + 1
        self._edge_px = edge_px

    def noise(self, residual: np.ndarray, told: np.ndarray, noise: Noise) -> np.ndarray:
        """Draws of noise, and of what a fit left unexplained beyond it [grey], (P, 3, DRAWS).

        Args:
            residual: That it left [grey], shape (P, 3).
            told: Pixels of each block that say something, shape (P, 3).
            noise: Of the photograph.
        """
        alike = np.sqrt(noise.shared_px / (4.0 * np.pi)) / self._edge_px
        variance = noise.of_block(told)
        unexplained = np.sqrt(TAKEN * self._beyond(residual, variance))
        noisy = np.sqrt(variance)[:, :, None] * self._drawn(alike, 0)
        return noisy + unexplained[:, :, None] * self._drawn(ALIKE, 1)

    def light(self, changed: np.ndarray, light_error: float) -> np.ndarray:
        """Draws of what the light of another sensor makes of a change [grey], (P, 3, DRAWS).

        Args:
            changed: By how much each block changed [grey], shape (P, 3).
            light_error: As `Untouched` has it.
        """
        return DOUBT * light_error * changed[:, :, None] * self._drawn(WIDE, 2)

    def _beyond(self, residual: np.ndarray, variance: np.ndarray) -> np.ndarray:
        """Variance of residuals around each block that noise does not explain, shape (P, 3)."""
        import cv2

        known = np.zeros((*self._shape, 1), np.float32)
        known[self._rows, self._columns] = 1.0
        square = np.zeros((*self._shape, 3), np.float32)
        square[self._rows, self._columns] = residual**2 - variance
        count = cv2.GaussianBlur(known, (0, 0), AROUND).reshape(*self._shape, 1)
        around = cv2.GaussianBlur(square, (0, 0), AROUND) / np.maximum(count, 1e-6)
        return np.maximum(around[self._rows, self._columns], 0.0)

    def _drawn(self, blur: float, number: int) -> np.ndarray:
        """Fields of variance 1 that are alike over a blur [blocks], shape (P, 3, DRAWS)."""
        import cv2

        random = np.random.default_rng((SEED, number))
        fields = random.normal(size=(*self._shape, 3 * DRAWS)).astype(np.float32)
        if blur > 0.3:
            kernel = cv2.getGaussianKernel(2 * int(np.ceil(3.0 * blur)) + 1, blur).astype(np.float32)
            fields = cv2.sepFilter2D(fields, -1, kernel, kernel) / float((kernel**2).sum())
        return fields[self._rows, self._columns].reshape(len(self._rows), 3, DRAWS)
