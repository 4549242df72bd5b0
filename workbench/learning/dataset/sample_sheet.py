"""A sheet of samples to look at: image, displacement and force of each, as one PNG file.

The skin is seen from outside along the target's normal: U points right, V up. Each vertex near the
target is drawn as a dot; colours go from zero to the largest value of that sample, written below.
"""

from __future__ import annotations

import numpy as np

from workbench.learning.dataset.folder import DataSet, SkinData
from workbench.learning.dataset.sample import Sample, Solved
from workbench.report.image_files import png_bytes
from workbench.system.whole_files import write_atomically

SHEET = "preview.png"
"""Data sets and the command `dataset preview` have called it so: folders keep the name."""
SHOWN = 8
"""Samples on a sheet."""
TILE_PX = 200
HALF_MM = 7.0
"""Half the width of the skin that is shown [mm]."""
LINE_PX = 18
INK = (30, 30, 30)


def write_sheet(data: DataSet) -> bool:
    """Write the sheet; False where no sample is done yet.

    Raises:
        StoreError: If a sample is damaged, or it cannot be written.
    """
    chosen = chosen_samples(data)
    if not chosen:
        return False
    columns = [_column(data.skin, sample) for sample in chosen]
    write_atomically(data.folder / SHEET, png_bytes(np.concatenate(columns, axis=1)))
    return True


def chosen_samples(data: DataSet) -> list[Sample]:
    """The last sample of cases spread evenly over those that have any."""
    cases = [(case, frames[-1]) for case in data.cases() if (frames := data.frames(case))]
    picks = np.unique(np.linspace(0, len(cases) - 1, min(SHOWN, len(cases))).astype(int))
    return [data.sample(*cases[pick]) for pick in picks.tolist()]


def _column(skin: SkinData, sample: Sample) -> np.ndarray:
    """Tiles of one sample, one below the other, sRGB."""
    import cv2

    tiles = [_caption(sample.indenter, sample.case.removeprefix(f"{sample.indenter}_"))]
    if sample.png:
        for image in (sample.image, sample.image_markers):
            height = round(TILE_PX * image.shape[0] / image.shape[1])
            tiles.append(cv2.resize(image, (TILE_PX, height), interpolation=cv2.INTER_AREA))
    for name, solved in (("mpm", sample.mpm), ("fem", sample.fem)):
        if solved is not None:
            tiles += _maps(skin, sample, solved, name)
    return np.concatenate([np.asarray(tile) for tile in tiles])


def _maps(skin: SkinData, sample: Sample, solved: Solved, name: str) -> list[np.ndarray]:
    moved_mm = np.linalg.norm(solved.displacement_mm, axis=1)
    force_N = np.linalg.norm(solved.contact_force_N, axis=1)
    return [
        _drawn(skin, sample, moved_mm),
        _caption(f"{name} moved to {moved_mm.max():.2f} mm"),
        _drawn(skin, sample, force_N),
        _caption(f"{name} nodal to {1e3 * force_N.max():.2f} mN"),
    ]


def _drawn(skin: SkinData, sample: Sample, values: np.ndarray) -> np.ndarray:
    """Values at the vertices about the target as dots, shape (TILE_PX, TILE_PX, 3), uint8."""
    import cv2

    away = skin.points_mm - sample.target_mm
    across = np.stack([sample.tangent_u, np.cross(sample.normal, sample.tangent_u)])
    place = away @ across.T
    near = (np.abs(place) < HALF_MM).all(axis=1) & (skin.normals @ sample.normal > 0.0)
    share = np.clip(255.0 * values / max(float(values.max(initial=0.0)), 1e-30), 0, 255)
    colours = cv2.applyColorMap(share.astype(np.uint8)[:, None], cv2.COLORMAP_VIRIDIS)[:, 0, ::-1]
    tile = np.full((TILE_PX, TILE_PX, 3), 255, np.uint8)
    scale = TILE_PX / (2.0 * HALF_MM)
    spacing_mm = float(np.sqrt(np.median(skin.areas_mm2)))
    radius = max(1, round(0.6 * spacing_mm * scale))
    for vertex in np.flatnonzero(near).tolist():
        u, v = place[vertex]
        centre = (round((u + HALF_MM) * scale), round((HALF_MM - v) * scale))
        cv2.circle(tile, centre, radius, colours[vertex].tolist(), -1)
    return tile


def _caption(*lines: str) -> np.ndarray:
    import cv2

    tile = np.full((LINE_PX * len(lines), TILE_PX, 3), 255, np.uint8)
    for number, line in enumerate(lines):
        place = (4, LINE_PX * (number + 1) - 5)
        cv2.putText(tile, line, place, cv2.FONT_HERSHEY_SIMPLEX, 0.36, INK, 1, cv2.LINE_AA)
    return tile
