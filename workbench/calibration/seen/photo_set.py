"""What a calibration is given: a photograph at rest, photographs of balls, and what is known.

A folder holds `idle.png`, the photographs and `presses.csv` with the columns `COLUMNS`: a name, the
ball's diameter, and, each of them optional, the circle of the contact, its depth and its force, and
where on the skin at rest a stage pressed the ball, in the sensor frame.
"""

from __future__ import annotations

import csv
import io
import math
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from sim.optics.raster.photo_file import read_rgb
from workbench.core.base.errors import DesignError, shown
from workbench.core.base.mapping import suggest
from workbench.core.design.photo import photo

IDLE, TABLE = "idle.png", "presses.csv"
CIRCLE, POSE = ("column_px", "row_px", "radius_px"), ("pose_x_mm", "pose_y_mm", "pose_z_mm")
COLUMNS = ("photo", "ball_mm", *CIRCLE, "depth_mm", "force_N", *POSE)
FEWEST = 5
"""Photographs to fit to: three colours of light from several sides need several slopes each."""
SMALLEST_BALL_MM, LARGEST_BALL_MM = 0.5, 100.0
LIMITS = {
    "radius_px": (1.0, 4096.0),
    "depth_mm": (0.01, 50.0),
    "force_N": (1e-4, 1e3),
    **dict.fromkeys(POSE, (-500.0, 500.0)),
}
"""Of what may be known of a press; a circle's middle must lie in the photograph."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Circle:
    """Where a contact is seen [px]: the middle of pixel (0, 0) is at column 0, row 0."""

    column_px: float
    row_px: float
    radius_px: float


@dataclass(frozen=True, kw_only=True, slots=True)
class BallPhoto:
    """One photograph of a ball that touches the sensor."""

    name: str
    image: np.ndarray
    """Shape (H, W, 3), uint8."""
    ball_mm: float
    """Diameter."""
    circle: Circle | None
    place_mm: np.ndarray | None
    """Where on the skin at rest a stage pressed the ball, shape (3,); None: nobody knows."""
    depth_mm: float | None
    force_N: float | None
    held_out: bool


@dataclass(frozen=True, kw_only=True, slots=True)
class PhotoSet:
    """Photographs of one size."""

    idle: np.ndarray
    """Shape (H, W, 3), uint8."""
    idle_png: bytes
    """The file itself."""
    photos: tuple[BallPhoto, ...]

    @property
    def fitted(self) -> tuple[BallPhoto, ...]:
        """Those that the light is fitted to."""
        return tuple(each for each in self.photos if not each.held_out)


def read_photo_set(folder: Path, held_out: tuple[str, ...] = ()) -> PhotoSet:
    """Read and check a folder of photographs.

    Args:
        folder: With `idle.png`, `presses.csv` and the photographs that it names.
        held_out: Names that are not fitted to, with or without their ending.

    Raises:
        DesignError: With the file's name: if one is missing or cannot be read, has another size,
            a row is wrong, a circle lies outside, or too few are left to fit to.
    """
    data = _bytes(folder, IDLE)
    idle = _image(IDLE, data)
    rows = _rows(folder)
    names = {row["photo"] for row in rows}
    wanted = {_known(name, names) for name in held_out}
    photos = tuple(_ball_photo(folder, row, idle, row["photo"] in wanted) for row in rows)
    left = sum(not each.held_out for each in photos)
    if left < FEWEST:
        raise DesignError(
            f"{folder / TABLE} leaves {left} photographs to fit to, fewer than {FEWEST}",
            hint="press a ball in more places, or hold fewer out; 10 to 20 places are good",
            at="--photos",
        )
    return PhotoSet(idle=idle, idle_png=data, photos=photos)


def _known(name: str, names: set[str]) -> str:
    """The photograph that a name with or without its ending stands for."""
    found = [each for each in names if name in (each, each.rpartition(".")[0])]
    if len(found) != 1:
        raise DesignError(
            f"{TABLE} has no photograph {shown(name)} to hold out",
            hint=suggest(name, names),
            at="--hold-out",
        )
    return found[0]


def _bytes(folder: Path, name: str) -> bytes:
    try:
        return (folder / name).read_bytes()
    except (OSError, ValueError) as error:
        raise DesignError(
            f"cannot read {folder / name}: {getattr(error, 'strerror', None) or error}",
            hint=f"a folder of photographs holds {IDLE}, {TABLE} and the photographs it names",
            at="--photos",
        ) from error


def _image(name: str, data: bytes) -> np.ndarray:
    """A photograph as grey levels, shape (H, W, 3), uint8."""
    shown_values = read_rgb(photo(name, data, at="--photos"), at="--photos", ground=0.0)
    return np.round(255.0 * shown_values).astype(np.uint8)


def _rows(folder: Path) -> list[dict[str, str]]:
    """The lines of the table, each photograph once."""
    try:
        text = _bytes(folder, TABLE).decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise DesignError(
            f"{folder / TABLE} is no UTF-8 text", hint="save it as UTF-8 CSV", at="--photos"
        ) from error
    reader = csv.DictReader(io.StringIO(text))
    missing = [name for name in COLUMNS[:2] if name not in (reader.fieldnames or ())]
    if missing:
        raise DesignError(
            f"{folder / TABLE} has no column {missing[0]}",
            hint=f"its first line is {','.join(COLUMNS)}",
            at="--photos",
        )
    rows = [{key: (row.get(key) or "").strip() for key in COLUMNS} for row in reader]
    rows = [row for row in rows if any(row.values())]
    names = Counter(row["photo"] for row in rows)
    twice = [name for name, times in names.items() if times > 1]
    if twice:
        raise DesignError(
            f"{folder / TABLE} names {shown(twice[0])} twice",
            hint="keep one line of each photograph",
            at="--photos",
        )
    return rows


def _ball_photo(folder: Path, row: dict[str, str], idle: np.ndarray, held_out: bool) -> BallPhoto:
    name = row["photo"]
    image = _image(name, _bytes(folder, name))
    if image.shape != idle.shape:
        raise DesignError(
            f"{name} has {image.shape[1]} x {image.shape[0]} pixels, {IDLE} "
            f"{idle.shape[1]} x {idle.shape[0]}",
            hint="take all photographs with the same settings of the camera",
            at="--photos",
        )
    ball_mm = _number(row, "ball_mm", SMALLEST_BALL_MM, LARGEST_BALL_MM)
    if ball_mm is None:
        raise DesignError(
            f"{name} has no ball_mm", hint="write the ball's diameter in mm", at="--photos"
        )
    return BallPhoto(
        name=name,
        image=image,
        ball_mm=ball_mm,
        circle=_circle(row, idle.shape[1], idle.shape[0]),
        place_mm=_place(row),
        depth_mm=_number(row, "depth_mm", *LIMITS["depth_mm"]),
        force_N=_number(row, "force_N", *LIMITS["force_N"]),
        held_out=held_out,
    )


def _circle(row: dict[str, str], width: int, height: int) -> Circle | None:
    """The contact's circle; None where nothing is written of it."""
    limits = ((0.0, width - 1.0), (0.0, height - 1.0), LIMITS["radius_px"])
    found = _all_or_none(row, dict(zip(CIRCLE, limits, strict=True)), "a circle")
    return None if found is None else Circle(**dict(zip(CIRCLE, found, strict=True)))


def _place(row: dict[str, str]) -> np.ndarray | None:
    """Where the ball touched, shape (3,); None where nothing is written of it."""
    found = _all_or_none(row, {name: LIMITS[name] for name in POSE}, "a pose")
    return None if found is None else np.array(found)


def _all_or_none(
    row: dict[str, str], limits: dict[str, tuple[float, float]], what: str
) -> list[float] | None:
    """Values that only say something together; None where all of them are empty."""
    values = {name: _number(row, name, *limit) for name, limit in limits.items()}
    given = [value for value in values.values() if value is not None]
    if given and len(given) < len(values):
        empty = next(name for name, value in values.items() if value is None)
        raise DesignError(
            f"{row['photo']} has {what} without {empty}",
            hint=f"give {', '.join(limits)}, or leave all of them empty",
            at="--photos",
        )
    return given or None


def _number(row: dict[str, str], name: str, low: float, high: float) -> float | None:
    """A value of the table; None where its place is empty."""
    text = row[name]
    if not text:
        return None
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not low <= value <= high:
        raise DesignError(
            f"{row['photo']}: {name} is {shown(text)}, not a number from {low:g} to {high:g}",
            hint="correct the table; leave the place empty where it is unknown",
            at="--photos",
        )
    return value
