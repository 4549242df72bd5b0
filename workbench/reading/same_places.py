"""Where another camera sees the places of the skin that the pixels of one see."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    # It needs the device that reading opens.
    from sim.reading.untouched import Untouched

OUTSIDE_PX = -1e3
"""A place that no image has."""
SURELY = 0.99
"""Share of the corners around a place that a camera sees, from which it sees the place."""


@dataclass(frozen=True, kw_only=True, slots=True)
class SamePlaces:
    """Of N = H W pixels of one camera, where another one sees the same skin at rest."""

    there_px: np.ndarray
    """Column and row from the middle of the first pixel, shape (H, W, 2), float32."""
    seen: np.ndarray
    """Whether both see it, shape (H, W), bool."""

    @classmethod
    def of(cls, one: Untouched, other: Untouched) -> SamePlaces:
        """Of two cameras before the same skin.

        Args:
            one: Whose pixels are asked about.
            other: In whose image their places are sought.
        """
        pixels = np.flatnonzero(one.sees)
        corners, weights = one.skin.faces[one.sight.face[pixels]], one.sight.weights[pixels]
        vertex_px = other.studio.vertex_pixels[:, :2] - 0.5
        known = other.studio.visible & np.isfinite(vertex_px).all(axis=1)
        share = np.einsum("pk,pk->p", weights, known[corners].astype(np.float64))
        found = np.einsum("pk,pkc->pc", weights, np.nan_to_num(vertex_px)[corners])
        both = share > SURELY
        there_px = np.full((len(one.sees), 2), OUTSIDE_PX, np.float32)
        seen = np.zeros(len(one.sees), dtype=bool)
        there_px[pixels[both]] = found[both]
        seen[pixels[both]] = True
        return cls(there_px=there_px.reshape(*one.shape, 2), seen=seen.reshape(one.shape))

    def brought(self, image: np.ndarray) -> np.ndarray:
        """An image of the other camera, (H', W') or (H', W', C), as this one would have it.

        Float32, of the shape of this one's; without meaning where not both see the skin.
        """
        import cv2

        across, down = (np.ascontiguousarray(self.there_px[:, :, axis]) for axis in range(2))
        values = image.astype(np.float32)
        return cv2.remap(values, across, down, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
