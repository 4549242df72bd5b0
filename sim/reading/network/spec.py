"""What a learned reader is: its size, what enters and what comes out, channel by channel.

It sees images 320 pixels wide, whatever the camera's size: the difference of two photographs, the
one at rest, and where a pixel stands. Convolutions run at half that and below.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass

COLUMNS = 320
"""Width of the images that a network sees [px]."""
STEP = 16
"""Images are padded to a multiple of it, as each level has half the rows of the one above."""
INPUTS = 8
"""Difference (3), photograph at rest (3), place across and down."""
SURFACE, DEPTH, TURN, TOUCH, PRESSURE, LOG_VARIANCE = 0, 1, slice(2, 5), 5, 6, 7
"""Channels that come out: inward displacement of the skin that the pixel saw at rest [mm], and of
the skin that it sees now [mm]; change of the inward unit normal (3); logit of being pressed in;
contact pressure over its scale; logarithm of the variance of the depth [mm2]."""
OUTPUTS = 8


@dataclass(frozen=True, kw_only=True, slots=True)
class ReaderSpec:
    """Size of a network."""

    widths: tuple[int, ...]
    """Channels of each level, the finest first; the finest has half of the rows and columns."""
    rows: int
    """Of the images that it sees."""
    columns: int = COLUMNS


SIZES = {"small": (12, 24, 48, 64), "full": (24, 48, 96, 144)}
"""Widths by name: 180,000 and 880,000 parameters."""


def spec_for(size: str, width_px: int, height_px: int) -> ReaderSpec:
    """The network of a size for a camera's images."""
    rows = max(1, round(COLUMNS * height_px / width_px))
    return ReaderSpec(widths=SIZES[size], rows=rows)


@dataclass(frozen=True, kw_only=True, slots=True)
class Scales:
    """What turns a network's numbers into units, and its variances into honest ones."""

    pressure_MPa: float
    force_N: float
    sigma: float = 1.0
    """Factor on the standard deviation of the depth."""
    force_sigma: float = 1.0
    """And on that of the force."""

    def with_factors(self, *, sigma: float, force_sigma: float) -> Scales:
        """The same units, other factors."""
        return dataclasses.replace(self, sigma=sigma, force_sigma=force_sigma)
