"""Programs that read such a table, and how their images come from it.

Two orders of colours are about. Taxim reads its photographs by OpenCV as blue, green, red and calls
blue `grad_r`; so does TacEx, which turns them again. Isaac Lab reads red, green, blue. Hence two
folders. Taxim and TacEx also smooth the image at rest before they add to it, which wipes out
markers, and much of an uneven light; Isaac Lab takes it as it is.
Source: `OpticalSimulation/simOptical.py` and `Basics/params.py` of Taxim, `taxim_torch.py` of
TacEx, `visuotactile_render.py` of Isaac Lab.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from workbench.taxim.table import looked_up

SIGMA_PX, DARKER, SHARE = 50.0, 5.0, 0.15
"""Of Taxim: blur, grey values that the blur is brighter by where it stands alone, its share
elsewhere."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Program:
    """Programs that read tables alike."""

    name: str
    """Of its folder."""
    reversed_colours: bool
    """Whether `grad_r` is blue."""
    smoothed: bool
    """Whether the image at rest is smoothed."""

    def base(self, rest: np.ndarray) -> np.ndarray:
        """What the table adds to, shape (H, W, 3), float64, of the image at rest."""
        image = rest.astype(float)
        return smoothed(image) if self.smoothed else image


PROGRAMS = (
    Program(name="isaac_lab", reversed_colours=False, smoothed=False),
    Program(name="taxim", reversed_colours=True, smoothed=True),
)


def smoothed(image: np.ndarray) -> np.ndarray:
    """The image at rest as Taxim smooths it, shape (H, W, 3)."""
    from scipy.ndimage import gaussian_filter

    blurred = gaussian_filter(image, SIGMA_PX, axes=(0, 1))
    as_bright = (blurred - image).mean(axis=2, keepdims=True) < DARKER
    return np.where(as_bright, SHARE * blurred + (1.0 - SHARE) * image, blurred)


def shown(base: np.ndarray, table: np.ndarray, height_px: np.ndarray) -> np.ndarray:
    """An image from a table, shape (H, W, 3), in [0, 255]; shadows left out.

    Args:
        base: What it is added to, shape (H, W, 3).
        table: Red, green, blue: shape (125, 125, 6, 3).
        height_px: Height toward the camera in pixels, shape (H, W).
    """
    return np.clip(base + looked_up(table, height_px), 0.0, 255.0)
