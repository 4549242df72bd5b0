"""What a camera sees of the skin at rest, as small as a learned reader needs it.

Pixels that see skin, their normals (coarsely: skins at rest are smooth), and where in the image
each vertex is seen.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

COARSE = 4
"""Pixels along each axis for one kept normal."""
FINE = 64
"""Steps of a vertex's place in a pixel."""
NOWHERE = 65535
LONGEST = 127


@dataclass(frozen=True, kw_only=True, slots=True)
class RestView:
    """Of an image of H x W pixels and V vertices of the seen skin."""

    sees: np.ndarray
    """Pixels that see skin, shape (H, W), bool."""
    coarse: np.ndarray
    """Inward unit normals times 127 of every fourth pixel, shape (H / 4, W / 4, 3), int8."""
    vertex_px: np.ndarray
    """u, v of the vertices, pixel centres at .5, shape (V, 2), float32; NaN of unseen ones."""

    @classmethod
    def made(cls, sees: np.ndarray, normals: np.ndarray, vertex_px: np.ndarray) -> RestView:
        """From full images.

        Args:
            sees: Shape (H, W), bool.
            normals: Inward unit normals, shape (H, W, 3); 0 without skin.
            vertex_px: As kept.
        """
        import cv2

        rows, columns = sees.shape
        size = (-(-columns // COARSE), -(-rows // COARSE))
        small = cv2.resize(normals.astype(np.float32), size, interpolation=cv2.INTER_AREA)
        small /= np.maximum(np.linalg.norm(small, axis=2, keepdims=True), 1e-6)
        coarse = np.round(LONGEST * small).astype(np.int8)
        return cls(sees=sees, coarse=coarse, vertex_px=vertex_px.astype(np.float32))

    def normals(self) -> np.ndarray:
        """Inward unit normals of all pixels, shape (H, W, 3), float32."""
        import cv2

        rows, columns = self.sees.shape
        full = cv2.resize(self.coarse.astype(np.float32), (columns, rows))
        return full / np.maximum(np.linalg.norm(full, axis=2, keepdims=True), 1e-6)

    def arrays(self) -> dict[str, np.ndarray]:
        """What a file keeps."""
        places = np.round(FINE * np.nan_to_num(self.vertex_px, nan=NOWHERE / FINE))
        return {
            "shape": np.array(self.sees.shape, np.int32),
            "sees": np.packbits(self.sees),
            "coarse": self.coarse,
            "vertex": np.clip(places, 0, NOWHERE).astype(np.uint16),
        }

    @classmethod
    def of(cls, arrays: Mapping[str, np.ndarray]) -> RestView:
        """From what a file keeps.

        Raises:
            KeyError, ValueError: If something is missing, or of another size.
        """
        rows, columns = (int(number) for number in arrays["shape"])
        sees = np.unpackbits(arrays["sees"], count=rows * columns).astype(bool)
        vertex = arrays["vertex"].astype(np.float32)
        vertex[(arrays["vertex"] == NOWHERE).any(axis=1)] = np.nan
        return cls(
            sees=sees.reshape(rows, columns), coarse=arrays["coarse"], vertex_px=vertex / FINE
        )
