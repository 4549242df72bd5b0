"""The designer maps of a run as files: every map on the skin, and their numbers."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

import numpy as np

from workbench.core.result.maps import PERCENTILES, DesignerMaps
from workbench.core.result.results import MembraneMesh
from workbench.system.folder import remove_stale
from workbench.system.whole_files import write_atomically

FILE = "maps.npz"


def write_maps(out: Path, mesh: MembraneMesh, maps: DesignerMaps | None) -> list[dict[str, Any]]:
    """Write `maps.npz` and return the rows of the summary; without maps none of both is left.

    The file holds `surface_points_mm (V,3)` and `surface_faces (F,3)` of the skin that the camera
    sees, and each map (V,) by its name, NaN where it has no value.
    """
    if maps is None:
        remove_stale(out, (FILE,), keep=())
        return []
    buffer = io.BytesIO()
    arrays = {found.name: np.asarray(found.values) for found in maps.maps}
    arrays["surface_points_mm"] = mesh.seen.points_mm
    arrays["surface_faces"] = mesh.seen.faces
    np.savez_compressed(buffer, allow_pickle=False, **arrays)
    write_atomically(out / FILE, buffer.getvalue())
    return [
        {
            "name": found.name,
            "label": found.label,
            "unit": found.unit,
            "percentiles": dict(
                zip(
                    (f"{share:g}" for share in PERCENTILES),
                    (float(value) for value in found.percentiles),
                    strict=True,
                )
            ),
            "score": {"name": found.score_name, "value": found.score, "better": found.better},
            "meaning": found.meaning,
        }
        for found in maps.maps
    ]
