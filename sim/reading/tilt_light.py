"""The light of each vertex by its tilt: what the design's own shading says, as a table.

The tilt (p, q) is the part of a unit inward normal across the normal at rest. Shadows that a dent
throws are left out here; the renderer knows them.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from sim.optics.light.device_arrays import readable
from sim.reading import tilt_kernels
from sim.reading.rest_skin import RestSkin
from workbench.core.base.monitor import Monitor, silent

STEPS = 15
"""Tilts along each axis."""
SPAN = 0.85
"""Largest of them: 58 degrees."""
STEEPEST = 0.985
"""Largest squared tilt of a corner of the table."""
STEP = 0.06
"""Of central differences of the light by the tilt."""


class TiltLight:
    """Radiance of V vertices."""

    def __init__(self, table: np.ndarray) -> None:
        """Keep a table, shape (V, STEPS, STEPS, 3), float32; the compute device must be open."""
        self.table = table
        self._there = readable(np.ascontiguousarray(table))

    def at(self, rows: np.ndarray, tilts: np.ndarray) -> np.ndarray:
        """Radiance of some vertices, (n,), at tilts (n, 2): shape (n, 3)."""
        light = np.empty((len(rows), 3))
        light_at: Any = tilt_kernels.light_at
        if len(rows):
            light_at(self._there, rows.astype(np.int32), tilts, SPAN, light)
        return light

    def slopes(self, rows: np.ndarray, tilts: np.ndarray) -> np.ndarray:
        """Its derivatives by both parts of the tilt, shape (n, 3, 2)."""
        slopes = np.empty((len(rows), 3, 2))
        slopes_at: Any = tilt_kernels.slopes_at
        if len(rows):
            slopes_at(self._there, rows.astype(np.int32), tilts, SPAN, STEP, slopes)
        return slopes

    def plainly_at(self, rows: np.ndarray, tilts: np.ndarray) -> np.ndarray:
        """The twin of `at`."""
        place = np.clip((tilts / SPAN + 1.0) * 0.5 * (STEPS - 1), 0.0, STEPS - 1.0 - 1e-6)
        cell = place.astype(np.int64)
        share = (place - cell)[:, :, None]
        (i, j), (a, b) = cell.T, (share[:, 0], share[:, 1])
        low = (1.0 - b) * self.table[rows, i, j] + b * self.table[rows, i, j + 1]
        high = (1.0 - b) * self.table[rows, i + 1, j] + b * self.table[rows, i + 1, j + 1]
        return (1.0 - a) * low + a * high

    def plain_slopes(self, rows: np.ndarray, tilts: np.ndarray) -> np.ndarray:
        """The twin of `slopes`."""
        columns = []
        for way in np.eye(2):
            ahead, behind = (
                self.plainly_at(rows, tilts + sign * STEP * way) for sign in (1.0, -1.0)
            )
            columns.append((ahead - behind) / (2.0 * STEP))
        return np.stack(columns, axis=2)


def tilt_light(
    skin: RestSkin,
    shade_tilted: Callable[[np.ndarray], np.ndarray],
    *,
    monitor: Monitor = silent,
) -> TiltLight:
    """Ask the shading for all tilts.

    Args:
        skin: The skin at rest.
        shade_tilted: `Studio.shade_tilted`.
        monitor: Progress and cancellation.
    """
    line = np.linspace(-SPAN, SPAN, STEPS)
    table = np.empty((skin.count, STEPS, STEPS, 3), dtype=np.float32)
    for i, p in enumerate(line):
        monitor(i / STEPS, "light by tilt")
        for j, q in enumerate(line):
            shrunk = min(1.0, np.sqrt(STEEPEST / max(p * p + q * q, 1e-12)))
            across = shrunk * p * skin.one + shrunk * q * skin.two
            along = np.sqrt(1.0 - (shrunk * p) ** 2 - (shrunk * q) ** 2)
            table[:, i, j] = shade_tilted(-(across + along * skin.inward).astype(np.float32))
    return TiltLight(table)
