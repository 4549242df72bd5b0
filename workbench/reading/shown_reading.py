"""A reading as the page shows it: pictures from the camera, colours on the skin, a profile."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

import numpy as np

from workbench.core.result.results import Skin
from workbench.view.colour_scale import NOTHING_GREY, YES, scale_colours

LEAST_MM, LEAST_DEG = 0.1, 5.0
"""Upper ends of colours, at least."""


class Look(StrEnum):
    """What is looked at."""

    PHOTO = "photo"
    DEPTH = "depth"
    TILT = "tilt"
    CONTACT = "contact"
    DEVIATION = "standard deviation"


@dataclass(frozen=True, kw_only=True, slots=True)
class Scale:
    """What the colours of a picture mean; from 0."""

    high: float
    unit: str


@dataclass(frozen=True, kw_only=True, slots=True)
class Told:
    """One quantity by pixel and by vertex; NaN where nothing is known."""

    pixels: np.ndarray
    """Shape (H, W)."""
    vertices: np.ndarray
    """Shape (V,)."""


@dataclass(frozen=True, kw_only=True, slots=True)
class ShownReading:
    """One photograph and what it says."""

    name: str
    image: np.ndarray
    """Shape (H, W, 3), uint8."""
    figures: dict[str, Any]
    """As `reading.json` has them."""
    skin: Skin
    """The seen skin, moved as read."""
    place_mm: np.ndarray
    """Of the moved skin that a pixel sees, shape (H, W, 3); NaN where it sees none."""
    told: dict[Look, Told]
    """All but the photo."""

    def scale(self, look: Look) -> Scale | None:
        """What the colours mean; None where they are no numbers."""
        if look in (Look.PHOTO, Look.CONTACT):
            return None
        least, unit = (LEAST_DEG, "degree") if look is Look.TILT else (LEAST_MM, "mm")
        high = float(np.nanmax(self.told[look].vertices, initial=0.0))
        return Scale(high=max(least, high), unit=unit)

    def picture(self, look: Look) -> np.ndarray:
        """What is looked at, by pixel, shape (H, W, 3), uint8."""
        return self.image if look is Look.PHOTO else self._coloured(look, self.told[look].pixels)

    def skin_colours(self, look: Look) -> np.ndarray:
        """The same by vertex, shape (V, 3), uint8; of the photo the depth."""
        look = Look.DEPTH if look is Look.PHOTO else look
        return self._coloured(look, self.told[look].vertices)

    def _coloured(self, look: Look, values: np.ndarray) -> np.ndarray:
        scale = self.scale(look)
        if scale is None:
            colours = np.where(values[..., None] > 0.5, YES, NOTHING_GREY)
            return colours.astype(np.uint8)
        return scale_colours(values, 0.0, scale.high)

    def profile(self, start_px: tuple[int, int], stop_px: tuple[int, int]) -> np.ndarray:
        """Way along the moved skin [mm] and depth [mm] on a line of pixels, shape (2, n).

        Args:
            start_px: Column and row.
            stop_px: The same; pixels that see no skin are left out, so n may be 0.
        """
        rows, columns = self.place_mm.shape[:2]
        count = int(np.abs(np.subtract(stop_px, start_px)).max()) + 1
        cells = np.rint(np.linspace(start_px, stop_px, count)).astype(int)
        column, row = np.clip(cells.T, 0, [[columns - 1], [rows - 1]])
        places, depth = self.place_mm[row, column], self.told[Look.DEPTH].pixels[row, column]
        known = np.isfinite(depth) & np.isfinite(places).all(axis=1)
        places, depth = places[known], depth[known]
        steps = np.linalg.norm(np.diff(places, axis=0), axis=1)
        return np.stack([np.concatenate([[0.0], np.cumsum(steps)])[: len(depth)], depth])


def turned(skin: Skin, points_mm: np.ndarray, normals: np.ndarray) -> Skin:
    """A skin at other places (V, 3) with other outward normals (V, 3)."""
    return dataclasses.replace(skin, points_mm=points_mm, normals=normals)
