"""Dents that objects leave in a skin, drawn from their shapes alone: a network learns shapes there.

No press, no light and no design go in. The skin goes where the object is and comes back beside it:

    u0 = max(0, d - h),    u <- max(u0, a mean(u)) some times,

with the height h of the object's lower side over a gently curved skin, the depth d and the mean
over the neighbours. What a reading does to a dent follows: it is smoothed, noisy, striped, and cut
off where the camera sees no further. All of it is drawn at random, widely: it need not be exact,
it must be varied. Source of the idea: Tobin and others, Domain randomization for transferring deep
neural networks from simulation to the real world, 2017.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import torch
from torch import Tensor, nn

from sim.contact.objects.object_measures import exact_distance, lowest_mm
from workbench.core.press.indenter import (
    DEFAULT_EDGE_RADIUS_MM,
    Indenter,
    IndenterKind,
    widest_edge_mm,
)
from workbench.tasks.networks.patch import HALF_MM, PATCH_PX

SIZES_MM = (3.0, 4.3, 6.1, 8.6, 12.0)
"""Of the objects, a factor of 1.42 apart; `ZOOM` fills what is between."""
ZOOM = 1.19
REACH_MM, CELLS = 9.0, 112
"""Half of the plane that an object's height is known over, and its cells."""
STEPS, TOUCHED_MM, NOWHERE_MM = 40, 0.02, 50.0
"""Of the way up to an object, the gap that counts as none, and the height where there is no object.
"""
SHIFT, CURVED_MM, FLAT = 0.12, (9.0, 40.0), 0.5
"""Of the middle over half a side; radii of the skin; how often its second curvature is none."""
DEPTH_MM, HELD, SPREADS = (0.2, 1.05), (0.86, 0.95), 14
"""Depths; what of a neighbour's depth is kept; how often it spreads, a pixel each time."""
BLUR_PX, NOISE, STRIPES, STRIPE_PX = (0.8, 2.2), 0.3, 0.15, (3.0, 8.0)
"""Of readings: blur, noise and stripes over the depth at most, and the period of stripes."""
CUT, CUT_PX, GAIN = 0.3, (4.0, 30.0), 0.15
"""How often a side is out of sight, how much of it, and by what a depth is off at most."""
UNEVEN, UNEVEN_CELLS, GRAIN_MM, GRAIN_PX = 0.4, 5, 0.1, 1.2
"""Of readings in a light that is not known well: by what depths are too large here and too small
there, over how many cells of the image, and the grain, at most, with its blur."""
HOLES, HOLE_CELLS, HOLE_LEVEL, HOLE_DEPTH = 0.3, 9, 1.6, 0.7
"""How often there are holes, over how many cells they are drawn, from how many standard deviations,
and by how much they are too shallow."""
LEAST_MM = 0.02
"""Depth below which there is no noise."""


class Dents:
    """An endless source of dents of some kinds of objects."""

    def __init__(self, kinds: Sequence[str], seed: int, device: str) -> None:
        """Find the lower sides of the objects, in seconds.

        Args:
            kinds: Names of `IndenterKind` that are no meshes; a dent's class is its number here.
            seed: Of all that is drawn.
            device: Where dents are drawn.
        """
        heights = [[height_mm(kind, size_mm) for size_mm in SIZES_MM] for kind in kinds]
        self._heights = torch.as_tensor(np.array(heights), dtype=torch.float32, device=device)
        self._generator = torch.Generator(device=device).manual_seed(seed)
        self._device = device

    def draw(self, count: int) -> tuple[Tensor, Tensor]:
        """Dents and how the skin lay before, and the class of each, (count,).

        The first are inward displacements and, behind them, how far the skin at rest lies inward
        of the plane that touches it in the middle [mm], shape (count, 2, `PATCH_PX`, `PATCH_PX`).
        """
        kinds = self._whole(len(self._heights), count)
        drop = self._drop(count)
        gap = self._height(kinds, count) + drop
        gap = gap - gap.amin(dim=(2, 3), keepdim=True)
        depth = self._between(DEPTH_MM, count, 1, 1, 1)
        spread = sprung((depth - gap).clamp(min=0.0), float(self._between(HELD, 1)))
        dents = self._as_read(blurred(spread, float(self._between(BLUR_PX, 1))), count)
        sight = self._in_sight(count)
        return torch.cat([misread(dents * sight, self._generator), drop * sight], dim=1), kinds

    def _drop(self, count: int) -> Tensor:
        """How far curved skin lies inward of the plane in the middle [mm]."""
        square = _places(self._device) ** 2
        once = 0.5 / self._between(CURVED_MM, count, 1, 1, 1)
        again = 0.5 / self._between(CURVED_MM, count, 1, 1, 1)
        again = again * (self._between((0.0, 1.0), count, 1, 1, 1) > FLAT)
        return once * square + again * square.transpose(2, 3)

    def _height(self, kinds: Tensor, count: int) -> Tensor:
        """Height of objects over a plane [mm], turned, mirrored, moved and enlarged."""
        zoom = ZOOM ** self._between((-1.0, 1.0), count)
        turn = self._between((-math.pi, math.pi), count)
        mirror = torch.sign(self._between((-1.0, 1.0), count))
        shift = self._between((-SHIFT, SHIFT), 2, count)
        share = HALF_MM / REACH_MM / zoom
        along, across = share * torch.cos(turn), share * torch.sin(turn)
        rows = [
            torch.stack([mirror * along, -across, shift[0]], dim=1),
            torch.stack([mirror * across, along, shift[1]], dim=1),
        ]
        size = [count, 1, PATCH_PX, PATCH_PX]
        grid = nn.functional.affine_grid(torch.stack(rows, dim=1), size, align_corners=False)
        heights = self._heights[kinds, self._whole(len(SIZES_MM), count)][:, None]
        over = nn.functional.grid_sample(heights, grid, padding_mode="border", align_corners=False)
        return over * zoom.view(-1, 1, 1, 1)

    def _as_read(self, dents: Tensor, count: int) -> Tensor:
        """Dents as a reading in a known light has them."""
        noise = torch.randn(dents.shape, generator=self._generator, device=self._device)
        noise = blurred(noise, 1.5) * dents.amax(dim=(2, 3), keepdim=True) * (dents > LEAST_MM)
        seen = dents + self._between((0.0, NOISE), count, 1, 1, 1) * noise
        way = self._between((0.0, math.pi), count, 1, 1, 1)
        cells = torch.arange(PATCH_PX, device=self._device, dtype=torch.float32).view(1, 1, 1, -1)
        along = torch.cos(way) * cells + torch.sin(way) * cells.transpose(2, 3)
        period = self._between(STRIPE_PX, count, 1, 1, 1)
        begun = self._between((0.0, 2.0 * math.pi), count, 1, 1, 1)
        stripes = torch.sin(2.0 * math.pi * along / period + begun)
        seen = seen * (1.0 + self._between((0.0, STRIPES), count, 1, 1, 1) * stripes)
        gain = 1.0 + GAIN * self._between((-1.0, 1.0), count, 1, 1, 1)
        return seen * gain

    def _in_sight(self, count: int) -> Tensor:
        """1 where the camera sees, 0 beyond the side that it does not: one of four, or none."""
        cells = torch.arange(PATCH_PX, device=self._device, dtype=torch.float32).view(1, 1, 1, -1)
        beyond = self._between(CUT_PX, count, 1, 1, 1)
        beyond = beyond * (self._between((0.0, 1.0), count, 1, 1, 1) < CUT)
        side = self._whole(4, count).view(-1, 1, 1, 1)
        over = torch.where(side % 2 == 0, cells, PATCH_PX - 1.0 - cells)
        down = torch.where(side % 2 == 0, cells, PATCH_PX - 1.0 - cells).transpose(2, 3)
        return (torch.where(side < 2, over, down) >= beyond).float()

    def _whole(self, below: int, count: int) -> Tensor:
        return torch.randint(below, (count,), generator=self._generator, device=self._device)

    def _between(self, span: tuple[float, float], *shape: int) -> Tensor:
        drawn = torch.rand(shape, generator=self._generator, device=self._device)
        return span[0] + (span[1] - span[0]) * drawn


def misread(dents_mm: Tensor, generator: torch.Generator) -> Tensor:
    """Dents (B, 1, h, w) [mm] as a reading has them whose light is not known well.

    With it in drawn and pressed dents 24 photographs of a finger's twin, whose light was not the
    design's, were told by .71 instead of .50, and renders as before.
    """
    device, count = dents_mm.device, len(dents_mm)

    def share() -> Tensor:
        return torch.rand((count, 1, 1, 1), generator=generator, device=device)

    def field(cells: int) -> Tensor:
        drawn = torch.randn((count, 1, cells, cells), generator=generator, device=device)
        size = list(dents_mm.shape[2:])
        return nn.functional.interpolate(drawn, size, mode="bicubic", align_corners=True)

    found = dents_mm * (1.0 + UNEVEN * share() * field(UNEVEN_CELLS)).clamp(min=0.0)
    holes = (field(HOLE_CELLS) > HOLE_LEVEL) & (share() < HOLES)
    grain = torch.randn(dents_mm.shape, generator=generator, device=device)
    return found * (1.0 - HOLE_DEPTH * holes) + GRAIN_MM * share() * blurred(grain, GRAIN_PX)


def height_mm(kind: str, size_mm: float) -> np.ndarray:
    """Height of an object's lower side over its lowest point, shape (`CELLS`, `CELLS`).

    It is walked up to from below by steps of the distance, which cannot pass through. Source: Hart,
    Sphere tracing, 1996. Where the object is not it is `NOWHERE_MM`.
    """
    name = IndenterKind(kind)
    edge_mm = min(DEFAULT_EDGE_RADIUS_MM, widest_edge_mm(name, size_mm) or DEFAULT_EDGE_RADIUS_MM)
    indenter = Indenter(name, size_mm=size_mm, edge_radius_mm=edge_mm)
    distance = exact_distance(indenter)
    steps_mm = ((np.arange(CELLS) + 0.5) / CELLS * 2.0 - 1.0) * REACH_MM
    place = np.stack([*np.meshgrid(steps_mm, steps_mm), np.zeros((CELLS, CELLS))], axis=2)
    place = place.reshape(-1, 3)
    lowest = -lowest_mm(indenter)
    place[:, 2] = lowest
    for _ in range(STEPS):
        place[:, 2] += np.maximum(distance(place), 0.0)
    found = np.where(distance(place) < TOUCHED_MM, place[:, 2] - lowest, NOWHERE_MM)
    return found.reshape(CELLS, CELLS)


def sprung(pressed_mm: Tensor, held: float) -> Tensor:
    """Skin that is pressed in (B, 1, h, w) [mm], with what it takes along beside the contact."""
    found = pressed_mm
    for _ in range(SPREADS):
        around = nn.functional.avg_pool2d(found, 3, stride=1, padding=1)
        found = torch.maximum(pressed_mm, held * around)
    return found


def blurred(images: Tensor, sigma_px: float) -> Tensor:
    """Images (B, 1, h, w) smoothed by a Gaussian."""
    reach = math.ceil(3.0 * sigma_px)
    off = torch.arange(-reach, reach + 1, device=images.device)
    line = torch.exp(-0.5 * (off / sigma_px) ** 2)
    line = line / line.sum()
    across = nn.functional.conv2d(images, line.view(1, 1, 1, -1), padding=(0, reach))
    return nn.functional.conv2d(across, line.view(1, 1, -1, 1), padding=(reach, 0))


def _places(device: str) -> Tensor:
    """Of columns from the middle [mm], shape (1, 1, 1, `PATCH_PX`)."""
    cells = torch.arange(PATCH_PX, device=device, dtype=torch.float32)
    return (((cells + 0.5) / PATCH_PX * 2.0 - 1.0) * HALF_MM).view(1, 1, 1, -1)
