"""The same touch seen by a camera that stands a little aside: images and truth moved alike.

Moves stand for a camera that was mounted by hand, as the built sensors do which views are rendered
by, but each image draws its own. A move in the image is what a small turn of the camera does; what
its place does to near and far skin is left to the built sensors.
"""

from __future__ import annotations

import dataclasses
import math

import torch
from torch.nn import functional

from sim.reading.network.loss import Wanted

SHIFT_PX, TURN_DEG, ZOOM = 3.0, 1.0, 0.02
"""Largest move along each axis, turn and change of size: 3 px of 320 are 1.3 degrees of a lens that
sees 100."""


def shifted(
    idle: torch.Tensor, photos: torch.Tensor, wanted: Wanted, generator: torch.Generator
) -> tuple[torch.Tensor, torch.Tensor, Wanted]:
    """Both photographs (B, 3, H, W) and what is true of them, each image moved by chance.

    The truth is taken from the nearest pixel; what comes from outside the image sees no skin.
    """
    count, _, rows, columns = photos.shape
    even = 2.0 * torch.rand(count, 4, generator=generator, device=photos.device) - 1.0
    angle, zoom = math.radians(TURN_DEG) * even[:, 2], 1.0 + ZOOM * even[:, 3]
    cosine, sine = zoom * torch.cos(angle), zoom * torch.sin(angle)
    # Places are counted from -1 to 1, so that a turn has to know the proportion of the image.
    tall = rows / columns
    theta = torch.stack(
        [
            torch.stack([cosine, -sine * tall, 2.0 * SHIFT_PX / columns * even[:, 0]], dim=1),
            torch.stack([sine / tall, cosine, 2.0 * SHIFT_PX / rows * even[:, 1]], dim=1),
        ],
        dim=1,
    )
    grid = functional.affine_grid(theta, [count, 3, rows, columns], align_corners=False)

    def seen(images: torch.Tensor) -> torch.Tensor:
        return functional.grid_sample(images, grid, padding_mode="border", align_corners=False)

    def true(maps: torch.Tensor) -> torch.Tensor:
        return functional.grid_sample(maps, grid, mode="nearest", align_corners=False)

    inside = (grid.abs() <= 1.0).all(dim=3)
    depth_mm = true(wanted.depth_mm[:, None])[:, 0]
    found = dataclasses.replace(
        wanted,
        depth_mm=torch.where(inside, depth_mm, torch.nan),
        surface_mm=true(wanted.surface_mm[:, None])[:, 0],
        turn=true(wanted.turn),
        pressure_MPa=true(wanted.pressure_MPa[:, None])[:, 0],
    )
    return seen(idle), seen(photos), found
