"""The views of a training in memory, and batches of them as tensors."""

from __future__ import annotations

import zipfile
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from workbench.core.base.errors import StoreError
from workbench.learning.readers.making import VIEWS
from workbench.learning.readers.view import View, block_from

if TYPE_CHECKING:
    import torch

    from sim.reading.network.loss import Wanted

READERS = 8
"""Threads that unpack files."""


@dataclass(frozen=True, kw_only=True, slots=True)
class ViewSet:
    """Views of one kind, and the built sensors that all of them name."""

    views: Sequence[View]
    idle: np.ndarray
    """Photographs at rest, shape (L, H, W, 3), uint8."""
    sees: np.ndarray
    """Pixels that see skin at rest, shape (L, H, W), bool."""

    def __len__(self) -> int:
        """How many views."""
        return len(self.views)

    def batch(
        self, numbers: Sequence[int], device: str
    ) -> tuple[torch.Tensor, torch.Tensor, Wanted]:
        """Photographs at rest and touched, (B, 3, H, W) grey, and what is true of them."""
        import torch

        from sim.reading.network.loss import Wanted

        views = [self.views[number] for number in numbers]
        looks = [view.look for view in views]
        idle = self.idle[looks]
        photos = idle.copy()
        rest = np.where(self.sees[looks], np.float16(0.0), np.float16(np.nan))
        maps = np.zeros((6, *rest.shape), np.float16)
        maps[0] = rest
        for row, view in enumerate(views):
            top, bottom, left, right = view.box
            cut = (row, slice(top, bottom), slice(left, right))
            photos[cut] = view.photo
            maps[(0, *cut)], maps[(1, *cut)] = view.depth_mm, view.surface_mm
            maps[(slice(2, 5), *cut)] = view.turn.transpose(2, 0, 1)
            maps[(5, *cut)] = view.pressure_MPa

        def tensor(values: np.ndarray) -> torch.Tensor:
            return torch.from_numpy(values).to(device, non_blocking=True).float()

        found = tensor(maps)
        rested, touched = (tensor(k).permute(0, 3, 1, 2).contiguous() for k in (idle, photos))
        return (
            rested,
            touched,
            Wanted(
                depth_mm=found[0],
                surface_mm=found[1],
                turn=found[2:5].permute(1, 0, 2, 3),
                pressure_MPa=found[5],
                force_N=tensor(np.stack([view.force_N for view in views])),
                solved=tensor(np.array([view.solved for view in views], np.float32)),
            ),
        )


def _look(path: Path) -> tuple[np.ndarray, np.ndarray]:
    try:
        with np.load(path) as file:
            return file["idle"], file["sees"]
    except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile) as error:
        raise StoreError(
            f"the built sensor {path} is damaged: {error}",
            hint="delete the folder of the training and train again",
            at=str(path),
        ) from error


def read_views(folder: Path, pattern: str) -> ViewSet:
    """The views of a training whose files have names of a pattern.

    Raises:
        StoreError: If a file is damaged.
    """
    looks = sorted((folder / VIEWS).glob("look-*.npz"))
    numbers = [int(path.stem.split("-")[1]) for path in looks]
    arrays = [_look(path) for path in looks]
    if not looks:
        return ViewSet(
            views=[], idle=np.zeros((0, 0, 0, 3), np.uint8), sees=np.zeros((0, 0, 0), bool)
        )
    count = max(numbers) + 1
    # A sensor that nothing was shown by, as time was up, has no views that would name it.
    idle = np.zeros((count, *arrays[0][0].shape), np.uint8)
    sees = np.zeros((count, *arrays[0][1].shape), bool)
    for number, (rested, seen) in zip(numbers, arrays, strict=True):
        idle[number], sees[number] = rested, seen
    paths = sorted((folder / VIEWS).glob(pattern))
    with ThreadPoolExecutor(READERS) as threads:
        blocks = list(threads.map(lambda path: block_from(path.read_bytes(), str(path)), paths))
    return ViewSet(views=[view for block in blocks for view in block], idle=idle, sees=sees)
