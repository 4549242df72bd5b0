"""A data set of made-up images, and photographs of the same: a spot in the shape of its object.

It stands where the skin is touched and is the brighter the deeper the press. So object, place,
depth and pressure can all be told from it.
"""

from __future__ import annotations

import dataclasses
import json
from pathlib import Path

import numpy as np

from tests.synthetic_presses import KINDS, made_up_sample, pad_recipe, pad_skin
from workbench.core.press.indenter import IndenterKind
from workbench.learning.dataset.begin import begin
from workbench.learning.dataset.cases import Case, cases_of
from workbench.learning.dataset.folder import DataSet
from workbench.learning.dataset.photo_labels import LABELS, table_bytes
from workbench.learning.dataset.recipe import Solvers
from workbench.learning.dataset.sample import Sample, to_bytes
from workbench.learning.dataset.sequences import SEQUENCES
from workbench.report.image_files import png_bytes
from workbench.system.whole_files import write_atomically

WIDTH, HEIGHT = 48, 36
REST = 60
SHAPES = dict(zip(KINDS, ("cross", "bar", "disc", "ring"), strict=True))
PX_PER_MM = 3.0


def picture(
    shape: str, middle_px: tuple[float, float], bright: float, shade: int = REST
) -> np.ndarray:
    """A spot on even grey, shape (H, W, 3), uint8."""
    down, across = np.mgrid[:HEIGHT, :WIDTH]
    x, y = np.abs(across - middle_px[0]), np.abs(down - middle_px[1])
    away = np.hypot(x, y)
    inside = {
        "cross": (np.minimum(x, y) < 1.6) & (away < 8.0),
        "bar": (x < 2.5) & (y < 8.0),
        "disc": away < 6.0,
        "ring": (away < 8.0) & (away > 5.0),
    }[shape]
    image = np.full((HEIGHT, WIDTH, 3), shade, np.uint8)
    image[inside] += np.uint8(bright)
    return image


def at_rest(shade: int = REST) -> bytes:
    """The untouched sensor as a PNG file."""
    return png_bytes(np.full((HEIGHT, WIDTH, 3), shade, np.uint8))


def place_px(case: Case) -> tuple[float, float]:
    """Where the spot of a case stands."""
    x, y, _ = case.position.target_mm
    return WIDTH / 2 + PX_PER_MM * x, HEIGHT / 2 + PX_PER_MM * y


def touched(folder: Path, *, cases: int = 80) -> DataSet:
    """A data set of four objects on the 25 places of the pad, two depths each, with images."""
    plan = dataclasses.replace(
        pad_recipe(cases=cases), images=True, shear_directions=0, solvers=Solvers.MPM
    )
    data = begin(folder, plan.table, pad_skin(plan, 1.0), cases_of(plan))
    for part in ("background", "background_markers"):
        write_atomically(folder / f"{part}.png", at_rest())
    for case in data.all_cases:
        for frame in range(case.frames):
            write_atomically(data.path(case, frame), to_bytes(_sample(data, case, frame)))
    return DataSet.open(folder)


def _sample(data: DataSet, case: Case, frame: int) -> Sample:
    bright = 150.0 * case.depth_at(frame) / case.depth_mm
    png = png_bytes(picture(SHAPES[case.indenter], place_px(case), bright))
    made = made_up_sample(data, case, frame)
    return dataclasses.replace(made, fem=None, png=png, png_markers=png)


def with_windows(data: DataSet, frames: int) -> None:
    """List a window with and one without slip for every case, of all of its frames."""
    rows = [
        {"case": case.id, "first": 0, "frames": frames, "slip": slip, "split": case.split.value}
        for case in data.cases()
        for slip in (False, True)
    ]
    text = "".join(json.dumps(row) + "\n" for row in rows)
    write_atomically(data.folder / SEQUENCES, text.encode())


def photographed(folder: Path, count: int = 40, *, shade: int = REST + 25) -> Path:
    """A photo folder of the same objects by another light, with all labels."""
    rng = np.random.default_rng(3)
    write_atomically(folder / "idle.png", at_rest(shade))
    rows = []
    for number in range(count):
        kind: IndenterKind = KINDS[number % len(KINDS)]
        x_mm, y_mm = rng.uniform(-3.0, 3.0, 2)
        depth_mm = float(rng.choice([0.2, 0.4]))
        middle = WIDTH / 2 + PX_PER_MM * x_mm, HEIGHT / 2 + PX_PER_MM * y_mm
        image = picture(SHAPES[kind], middle, 375.0 * depth_mm, shade)
        write_atomically(folder / f"p{number:03d}.png", png_bytes(image))
        rows.append(
            {
                "photo": f"p{number:03d}.png",
                "object": kind.value,
                "place": f"place{number % 7}",
                "depth_mm": depth_mm,
                "peak_MPa": depth_mm,
                "pose_x_mm": float(x_mm),
                "pose_y_mm": float(y_mm),
            }
        )
    write_atomically(folder / LABELS, table_bytes(rows))
    return folder


def sequence_folder(folder: Path, count: int = 12) -> Path:
    """Windows of eight photographs: a grid of dots that stays, or moves by 4 px, as slip does."""
    write_atomically(folder / "idle.png", png_bytes(dots(0.0)))
    rows = []
    for number in range(count):
        slip = number % 2
        for frame in range(8):
            name = f"s{number:02d}_{frame}.png"
            write_atomically(folder / name, png_bytes(dots(4.0 * slip * frame / 7.0)))
            rows.append(
                {
                    "photo": name,
                    "sequence": f"s{number:02d}",
                    "frame": frame,
                    "slip": slip,
                    "place": f"place{number}",
                }
            )
    write_atomically(folder / LABELS, table_bytes(rows))
    return folder


def dots(moved_px: float) -> np.ndarray:
    """Dark dots on grey, moved across, shape (H, W, 3), uint8."""
    down, across = np.mgrid[:HEIGHT, :WIDTH]
    x, y = (across - moved_px) % 12.0 - 6.0, down % 12.0 - 6.0
    grey = 160.0 - 120.0 * np.exp(-(x**2 + y**2) / 4.0)
    return np.repeat(grey.round().astype(np.uint8)[..., None], 3, axis=2)
