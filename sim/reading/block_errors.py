"""Draws of what blocks of pixels are off by: noise, and light that is not the sensor's.

Noise is as large and as alike from pixel to pixel as where nothing changed (`noise`). Light that is
off shows twice. Residuals that noise does not explain are smooth, and a fit has already taken from
them what a displacement can imitate: one of three colours, about, so that half as much again is
drawn, as large in each place as what was left around it. And where the photograph at rest is not
what the design would show, a change is not either, of which a fit leaves nothing: normals that are
turned alike explain a lamp that stands elsewhere.
"""

from __future__ import annotations

import functools

import numpy as np

from sim.reading.deviation import DRAWS
from sim.reading.noise import Noise

TAKEN = 1.5
"""Variance of an error of light over what a fit leaves of it."""
ALIKE = 2.0
"""Blur of such an error [blocks]."""
AROUND = 3.0
"""Blur of its variance [blocks]."""
DOUBT = 5.0
"""Standard deviation of what the light makes of a change, over how far the light at rest is off:
lamps in another place shine from another side, which the photograph at rest shows but little. Of
five sensors with lamps, coating and camera off, 66 % of the errors of dents are then within one
standard deviation on average, of one sensor 25 to 100 %."""
WIDE = 8.0
"""Blur of such an error [blocks]: a dent is read too deep or too shallow as a whole."""
POINT = 0.3
"""Blur below which blocks are independent [blocks]."""
SEED = 2
ROUND = 16
"""To whose multiples fields are enlarged [blocks]: those of the next photograph are there then."""


class BlockErrors:
    """Errors of P blocks of an image."""

    def __init__(self, rows: np.ndarray, columns: np.ndarray, edge_px: int) -> None:
        """Keep the places of the blocks.

        Args:
            rows: Counted in blocks, shape (P,).
            columns: Likewise.
            edge_px: Of a block.
        """
        self._rows = rows - rows.min(initial=int(rows.max(initial=0)))
        self._columns = columns - columns.min(initial=int(columns.max(initial=0)))
        self._shape = int(self._rows.max(initial=0)) + 1, int(self._columns.max(initial=0)) + 1
        self._edge_px = edge_px

    def noise(self, residual: np.ndarray, told: np.ndarray, noise: Noise) -> np.ndarray:
        """Draws of noise, and of what a fit left unexplained beyond it [grey], (P, 3, DRAWS).

        Args:
            residual: That it left [grey], shape (P, 3).
            told: Pixels of each block that say something, shape (P, 3).
            noise: Of the photograph.
        """
        # Noise blurred by b is correlated as exp(-r^2 / 4 b^2), which sums to 4 pi b^2.
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

        sums = np.zeros((*self._shape, 4), np.float32)
        sums[self._rows, self._columns, :3] = residual**2 - variance
        sums[self._rows, self._columns, 3] = 1.0
        around = cv2.GaussianBlur(sums, (0, 0), AROUND)[self._rows, self._columns]
        return np.maximum(around[:, :3] / around[:, 3:], 0.0)

    def _drawn(self, blur: float, number: int) -> np.ndarray:
        """Fields of variance 1 that are alike over a blur [blocks], shape (P, 3, DRAWS)."""
        rows, columns = (-(-size // ROUND) * ROUND for size in self._shape)
        found = _fields(rows, columns, blur, number)[self._rows, self._columns]
        return found.reshape(len(self._rows), 3, DRAWS)


@functools.lru_cache(maxsize=16)
def _fields(rows: int, columns: int, blur: float, number: int) -> np.ndarray:
    """Fields of variance 1, shape (rows, columns, 3 DRAWS): the same for the next photograph."""
    import cv2

    # Drawn beyond the blocks, as a blur that ends at them would be mirrored there.
    reach = int(np.ceil(3.0 * blur)) if blur > POINT else 0
    random = np.random.default_rng((SEED, number))
    shape = rows + 2 * reach, columns + 2 * reach, 3 * DRAWS
    fields = random.standard_normal(shape, dtype=np.float32)
    if reach:
        kernel = cv2.getGaussianKernel(2 * reach + 1, blur).astype(np.float32)
        fields = cv2.sepFilter2D(fields, -1, kernel, kernel) / float((kernel**2).sum())
    return fields[reach : rows + reach, reach : columns + reach]
