"""A volume mesh as a compressed NumPy archive."""

from __future__ import annotations

import io

import numpy as np

from workbench.core.result.results import VolumeMesh


def volume_bytes(mesh: VolumeMesh) -> bytes:
    """A compressed NumPy archive of nodes, cells, labels and numbers."""
    buffer = io.BytesIO()
    np.savez_compressed(
        buffer,
        points_mm=mesh.points_mm,
        cells=mesh.cells,
        labels=mesh.labels,
        numbers=mesh.numbers,
    )
    return buffer.getvalue()
