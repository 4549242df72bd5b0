"""What of a texture the contact stage and its skin do not show, as a raster over body X and Y.

f = h - G h: the height field of the object less what reaches the image through the samples of the
distance and the triangles of the skin. G is the mean where contact feels a pattern as a flat
layer, else a Gaussian filter whose variance is the sum of

    edge^2 / 2        normals of a skin with edges of this root mean square: averaged over the
                      triangles about a vertex (edge^2 / 3), interpolated between (edge^2 / 6)
    (1.5 samples)^2   for what `textures` filters before contact sees it

Vertices follow what the samples hold to 0.88-0.99 of its amplitude (waves of 2 to 8 grid cells on
a flat skin, measured), so the grid takes nothing away. With edges of 0.4 mm, waves of 1 mm are
left to the detail by 79 %, of 2 mm by 33 %, of 4 mm by 9 %.
`f` has no mean, so the detail adds nothing to how deep an object sits.

Left out: meshes, of which what is finer than the samples stays as the samples have it; that places
on the skin are filtered less than its normals (edge^2 / 6), so that depth shows of waves that the
skin carries in part up to a quarter of their amplitude twice.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim.contact.objects import textures
from sim.contact.objects.sampling import SAMPLES_PER_CELL
from workbench.core.press.texture import Pattern, Texture

STEP_MM = 0.02
"""Distance of the raster's points, and half the span of its slopes [mm]."""
LEAST_STEPS, MOST_STEPS = 64, 1024
"""Points per period of a repeated pattern."""
MOST_POINTS = 4_000_000
"""Of a picture or a line of letters; coarser than `STEP_MM` where they are larger."""
MARGIN_SIGMAS = 4.0
LEAST_RANGE_MM = 1e-4
"""Less relief than this is none: a tenth of a micrometre."""
FLAT = 1e-3
"""Share of the steepest slope below which a place is flat ground beside a pattern."""


@dataclass(frozen=True, kw_only=True, slots=True)
class FineSurface:
    """Heights that the image adds, toward body -Z."""

    raster: np.ndarray
    """Height [mm], slope along X and slope along Y [1], shape (A, B, 3), float32; A along X."""
    origin_mm: np.ndarray
    """Place of entry (0, 0) [mm], shape (2,)."""
    step_mm: float
    repeats: bool
    """Whether the raster is one period, or all there is."""
    low_mm: float
    high_mm: float
    """Deepest valley and highest crest [mm]."""
    slope_rms: float
    """Root mean square of the slope, over the part that is not flat [1]."""

    def read(self, place_mm: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Heights [mm], (N,), and slopes along X and Y, (N, 2), at body places (N, 2): linear."""
        steps = (place_mm - self.origin_mm) / self.step_mm
        count = np.array(self.raster.shape[:2])
        low = np.floor(steps).astype(np.int64)
        share = (steps - low).astype(np.float32)
        outside = np.zeros(len(low), dtype=bool)
        if not self.repeats:
            outside = ((low < 0) | (low > count - 2)).any(axis=1)
        total = np.zeros((len(low), 3), dtype=np.float32)
        for i in (0, 1):
            for j in (0, 1):
                across = share[:, 0] if i else 1.0 - share[:, 0]
                along = share[:, 1] if j else 1.0 - share[:, 1]
                row, column = (low[:, 0] + i) % count[0], (low[:, 1] + j) % count[1]
                total += (across * along)[:, None] * self.raster[row, column]
        total[outside] = 0.0
        return total[:, 0], total[:, 1:]


def fine_surface(texture: Texture, *, grid_mm: float, edge_mm: float) -> FineSurface | None:
    """What contact leaves of a texture; None where that is nothing.

    Args:
        texture: Of the object.
        grid_mm: Edge of a cell of the contact grid.
        edge_mm: Root mean square of the edges of the skin's triangles.

    Raises:
        DesignError: If its ridges are too narrow for an image.
    """
    if not texture.raised or not texture.height_mm:
        return None
    spacing_mm = grid_mm / SAMPLES_PER_CELL
    sigma_mm = float(np.hypot(textures.filter_mm(texture, spacing_mm), edge_mm / 2.0**0.5))
    repeats = texture.pattern not in (Pattern.LETTERS, Pattern.IMAGE)
    origin_mm, step_mm, shape = _frame(texture, sigma_mm, repeats)
    field = textures.true_heights(texture)
    y = origin_mm[1] + step_mm * np.arange(shape[1])
    rows = [
        field(np.column_stack([np.full(len(y), x), y]))
        for x in origin_mm[0] + step_mm * np.arange(shape[0])
    ]
    height = np.stack(rows)
    fine = height - _resolved(height, sigma_mm / step_mm, repeats)
    if float(np.ptp(fine)) < LEAST_RANGE_MM:
        return None
    slopes = _slopes(fine, step_mm, repeats)
    return FineSurface(
        raster=np.concatenate([fine[..., None], slopes], axis=2).astype(np.float32),
        origin_mm=origin_mm,
        step_mm=step_mm,
        repeats=repeats,
        low_mm=float(fine.min()),
        high_mm=float(fine.max()),
        slope_rms=_slope_rms(np.linalg.norm(slopes, axis=2)),
    )


def _frame(
    texture: Texture, sigma_mm: float, repeats: bool
) -> tuple[np.ndarray, float, tuple[int, int]]:
    """Origin [mm], step [mm] and shape of the raster."""
    if repeats:
        count = int(np.clip(np.ceil(texture.pitch_mm / STEP_MM), LEAST_STEPS, MOST_STEPS))
        return np.zeros(2), texture.pitch_mm / count, (count, count)
    width_mm, height_mm = _extent_mm(texture)
    size = np.array([width_mm, height_mm]) + 2.0 * MARGIN_SIGMAS * sigma_mm
    step_mm = max(STEP_MM, float(np.sqrt(size.prod() / MOST_POINTS)))
    count = np.ceil(size / step_mm).astype(int) + 1
    return -0.5 * step_mm * (count - 1), step_mm, (int(count[0]), int(count[1]))


def _extent_mm(texture: Texture) -> tuple[float, float]:
    """Width and height of a picture or a line of letters [mm]."""
    if texture.image is not None:
        rows, columns = texture.image.heights.shape
        return texture.pitch_mm, texture.pitch_mm * rows / columns
    # A letter is at most as wide as it is high; a margin of half a capital surrounds them.
    return texture.pitch_mm * (len(texture.text) + 1.0), 2.0 * texture.pitch_mm


def _resolved(height: np.ndarray, sigma: float, repeats: bool) -> np.ndarray:
    """What contact sees of heights; `sigma` in points."""
    from scipy.ndimage import gaussian_filter

    if not np.isfinite(sigma):
        return np.full_like(height, height.mean())
    return gaussian_filter(height, sigma, mode="wrap" if repeats else "constant")


def _slopes(height: np.ndarray, step_mm: float, repeats: bool) -> np.ndarray:
    """Central differences along both axes, shape (A, B, 2)."""
    if not repeats:
        along_x, along_y = np.gradient(height, step_mm)
        return np.stack([along_x, along_y], axis=-1)
    differences = [np.roll(height, -1, axis) - np.roll(height, 1, axis) for axis in (0, 1)]
    return np.stack(differences, axis=-1) / (2.0 * step_mm)


def _slope_rms(steep: np.ndarray) -> float:
    """Root mean square of slopes (A, B) without the ground beside a pattern."""
    from scipy.ndimage import binary_dilation

    # A crest is level too, but only along a line.
    relief = np.flatnonzero(binary_dilation(steep > FLAT * steep.max()))
    return float(np.sqrt(np.mean(steep.ravel()[relief] ** 2)))
