"""Files of readings: arrays and a picture of each photograph, and a table of all."""

from __future__ import annotations

import io
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from workbench.reading.learned_reader import LearnedReading
from workbench.reading.read_photo import Reading
from workbench.report.image_files import png_bytes
from workbench.system.whole_files import write_atomically
from workbench.view.colour_scale import scale_colours

TABLE = "reading.json"
LEAST_SCALE_MM = 0.1
"""Depth at the upper end of a picture's colours, at least."""


def names_of(photos: Sequence[Path]) -> list[str]:
    """What each photograph's files are called: its name without its ending, numbered if twice."""
    found: list[str] = []
    for path in photos:
        name, number = path.stem, 2
        while name in found:
            name, number = f"{path.stem}_{number}", number + 1
        found.append(name)
    return found


def write_reading(out: Path, name: str, reading: Reading | LearnedReading) -> None:
    """Write `NAME.npz` and `NAME_depth.png`."""
    buffer, maps = io.BytesIO(), reading.maps
    more: dict[str, Any] = reading.more
    np.savez_compressed(
        buffer,
        depth_mm=maps.depth_mm,
        normal=maps.normal,
        contact=maps.contact,
        sigma_mm=maps.sigma_mm,
        surface_displacement_mm=reading.surface_mm.astype(np.float32),
        surface_sigma_mm=reading.surface_sigma_mm.astype(np.float32),
        force_N=reading.force_N,
        force_sigma_N=np.float64(reading.force_sigma_N),
        **more,
    )
    write_atomically(out / f"{name}.npz", buffer.getvalue())
    top_mm = max(LEAST_SCALE_MM, float(np.nanmax(maps.depth_mm, initial=0.0)))
    write_atomically(
        out / f"{name}_depth.png", png_bytes(scale_colours(maps.depth_mm, 0.0, top_mm))
    )


def write_table(out: Path, rows: Sequence[dict[str, Any]]) -> None:
    """Write `reading.json`: the figures of readings, in the order of the photographs."""
    write_atomically(out / TABLE, (json.dumps(rows, indent=1, allow_nan=False) + "\n").encode())
