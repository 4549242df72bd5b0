"""Several sources' forces of one press on the skin of the design, as named arrays and columns.

What a source does not know is left out: files hold no NaN.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from sim.forces.peaks import DISC_MM, Triangles
from workbench.core.result.force_field import Source
from workbench.view.force_sources import Forces, totals
from workbench.view.forces import Columns

FIELDS = ("displacement_mm", "contact_force_N", "pressure_MPa", "reaction_N", "moment_Nmm",
          "sliding_share")  # fmt: skip
"""Fields of every source, as they are named in its result."""
TOTALS = ("normal_N", "tangential_N")
PEAKS = ("peak_MPa", "peak_disc_N")


def source_columns(
    found: Mapping[Source, Forces], depths_mm: np.ndarray, skin: Triangles
) -> Columns:
    """Totals and peaks of every frame and source by name, each of shape (K,)."""
    columns: Columns = {
        "frame": np.arange(1, len(depths_mm) + 1),
        "depth_mm": depths_mm,
        "disc_mm": np.full(len(depths_mm), DISC_MM),
    }
    for source, forces in found.items():
        rows = [totals(source, forces, frame, skin) for frame in range(len(depths_mm))]
        for name in (*TOTALS, *PEAKS):
            values = np.array([getattr(row, name) for row in rows])
            if np.isfinite(values).all():
                columns[f"{source.value}_{name}"] = values
        if len(forces.sliding_share):
            columns[f"{source.value}_sliding_share"] = forces.sliding_share
    return columns


def source_arrays(
    found: Mapping[Source, Forces], columns: Columns, skin: Triangles
) -> dict[str, np.ndarray]:
    """The arrays of `sources.npz`: those of all, then each source's with its name before them.

    Args:
        found: The sources, on the skin.
        columns: Of `source_columns`, for depths and peaks.
        skin: Of the design, at rest.
    """
    arrays = {
        "points_mm": np.asarray(skin.points_mm),
        "faces": np.asarray(skin.faces),
        "depth_mm": columns["depth_mm"],
        "disc_mm": np.array(DISC_MM),
    }
    for source, forces in found.items():
        for name in FIELDS:
            values = np.asarray(getattr(forces, name))
            if len(values):
                arrays[f"{source.value}_{name}"] = values
        for name in (f"{source.value}_{peak}" for peak in PEAKS):
            if name in columns:
                arrays[name] = columns[name]
    return arrays
