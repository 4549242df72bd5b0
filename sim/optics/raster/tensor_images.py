"""Images, depths and dots of an `Imager` as tensors of PyTorch on the device that drew them."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from sim.optics.light import copy_kernels
from sim.optics.light.tensor_device import tensor_device
from sim.optics.raster.imager import Imager
from sim.optics.raster.raster_kernels import SAME

if TYPE_CHECKING:
    import torch


class TensorImages:
    """Draws displaced skins that lie on the device, by an imager and in its batches."""

    def __init__(self, imager: Imager, rest_depth_mm: np.ndarray) -> None:
        """An imager, and the depth of the untouched skin, (H, W), float32."""
        import torch

        self._imager = imager
        device, back = tensor_device(), imager.backdrop
        self._background = torch.from_numpy(back.background_rgb).to(device)
        self._rest_depth = torch.from_numpy(rest_depth_mm.ravel()).to(device)
        self._rest_marker = torch.from_numpy(back.marker).to(device).long()
        self._rest_ink = torch.from_numpy(back.ink).to(device)

    def images(self, moved_mm: torch.Tensor) -> torch.Tensor:
        """Images of skins, (B, V, 3) [mm], float32: (B, H, W, 3), uint8."""
        found = self._background.repeat(len(moved_mm), 1, 1)
        for batch in self._batches(moved_mm):
            self._imager.draw_over(found[batch])
        return found.reshape(-1, *self._imager.shape, 3)

    def looks(self, moved_mm: torch.Tensor) -> tuple[torch.Tensor, torch.Tensor]:
        """Depths (B, H, W) [mm] and dots (B, M, 2) [px] of skins, float32; NaN of what is unseen.

        Sums over the ink of a dot are in no fixed order, in float64.
        """
        count, imager = len(moved_mm), self._imager
        depth = self._rest_depth.repeat(count, 1)
        dots = moved_mm.new_empty((count, len(imager.backdrop.dots_mm), 2))
        for batch in self._batches(moved_mm):
            frames = len(depth[batch])
            normal = moved_mm.new_zeros((frames * imager.raster.pixels, 3))
            imager.describe(normal, depth[batch].view(-1), frames)
            if dots.shape[1]:
                dots[batch] = self._dots(frames)
        return depth.reshape(-1, *imager.shape), dots

    def _batches(self, moved_mm: torch.Tensor) -> Iterator[slice]:
        for first in range(0, len(moved_mm), self._imager.raster.frames):
            batch = slice(first, min(first + self._imager.raster.frames, len(moved_mm)))
            self._imager.look_at(moved_mm[batch])
            yield batch

    def _dots(self, frames: int) -> torch.Tensor:
        """Centres of the dots in the frames looked at; `markers.centroids` is the twin."""
        import torch

        imager = self._imager
        size, device = frames * imager.raster.pixels, self._background.device
        triangle, marker = (torch.empty(size, dtype=torch.int32, device=device) for _ in range(2))
        ink = torch.empty(size, device=device)
        of_dots, share = imager.inked
        copy_kernels.copy_integers(imager.raster.seen.triangle, triangle)
        copy_kernels.copy_integers(of_dots, marker)
        copy_kernels.copy_numbers(share, ink)
        changed = triangle.reshape(frames, -1) != SAME
        ink = torch.where(changed, ink.reshape(frames, -1), self._rest_ink).double()
        marker = torch.where(changed, marker.reshape(frames, -1).long(), self._rest_marker)
        width = imager.shape[1]
        place = torch.arange(ink.shape[1], device=device)
        sums = ink.new_zeros((3, frames, len(imager.backdrop.dots_mm)))
        sums[0].scatter_add_(1, marker, ink)
        sums[1].scatter_add_(1, marker, ink * (place % width + 0.5))
        sums[2].scatter_add_(1, marker, ink * (place // width + 0.5))
        return (sums[1:] / sums[0]).permute(1, 2, 0).float()
