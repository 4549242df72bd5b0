"""Parts of images around the contact: most of an image is at rest, and says little more."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import torch

from sim.reading.network.loss import Wanted
from sim.reading.network.spec import STEP

Box = tuple[int, int, int, int]


def cut_to_contact(
    enters: torch.Tensor,
    wanted: Wanted,
    boxes: Sequence[Box],
    window: tuple[int, int],
    rng: np.random.Generator,
) -> tuple[torch.Tensor, Wanted]:
    """The same batch, of each image a window that holds as much of what changed as it can.

    Where it cannot hold all, pressure and force count as unknown.

    Args:
        enters: What enters the network, shape (B, INPUTS, H, W).
        wanted: What is true.
        boxes: Of what changed in each image: first and last row, first and last column.
        window: Rows and columns, multiples of `STEP`; larger than the image is the image.
        rng: Places the window where there is a choice.
    """
    rows = min(window[0], enters.shape[2] // STEP * STEP)
    columns = min(window[1], enters.shape[3] // STEP * STEP)
    truth_rows, truth_columns = wanted.depth_mm.shape[1:]
    places = []
    for top, low, left, far in boxes:
        bottom, right = min(low, truth_rows), min(far, truth_columns)
        row = _begin(top, bottom, rows, min(enters.shape[2], truth_rows), rng)
        column = _begin(left, right, columns, min(enters.shape[3], truth_columns), rng)
        whole = row <= top and bottom <= row + rows and column <= left and right <= column + columns
        places.append((row, column, whole))

    def cut(values: torch.Tensor) -> torch.Tensor:
        parts = [
            values[number, ..., row : row + rows, column : column + columns]
            for number, (row, column, _) in enumerate(places)
        ]
        return torch.stack(parts)

    solved = [float(whole) for _, _, whole in places]
    return cut(enters), Wanted(
        depth_mm=cut(wanted.depth_mm),
        surface_mm=cut(wanted.surface_mm),
        turn=cut(wanted.turn),
        pressure_MPa=cut(wanted.pressure_MPa),
        force_N=wanted.force_N,
        solved=wanted.solved * torch.tensor(solved, device=wanted.solved.device),
    )


def wider(box: Box, by_px: int) -> Box:
    """A box with a margin; at the image's upper and left edges none."""
    top, bottom, left, right = box
    return max(top - by_px, 0), bottom + by_px, max(left - by_px, 0), right + by_px


def _begin(first: int, last: int, size: int, of: int, rng: np.random.Generator) -> int:
    """Where a window of a size begins, of so many pixels, to hold what it can of a span."""
    low, high = sorted((last - size, first))
    low, high = max(low, 0), min(high, of - size)
    return int(rng.integers(low, high + 1)) if low < high else int(np.clip(low, 0, of - size))
