"""A folder of labelled photographs: read and checked before anything is learned.

`workbench.learning.dataset.photo_labels` says what is in it. Without `labels.csv` its folders name
the classes of what is in them. All photographs have the size of theirs at rest, and the proportion
of the design's camera, whose view they are taken for.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from workbench.core.base.errors import DesignError, shown
from workbench.core.design.camera import Camera
from workbench.core.design.photo import PICTURE_ENDINGS
from workbench.learning.dataset.photo_labels import (
    FRAME,
    IDLE,
    LABELS,
    OBJECT,
    OWN_IDLE,
    PHOTO,
    PLACE,
    SEQUENCE,
    SLIP,
)
from workbench.learning.dataset.sequences import FRAMES
from workbench.photographs.photo_files import decoded
from workbench.tasks.examples import Seen, columns_of
from workbench.tasks.seen_images import View, change, motion
from workbench.tasks.task import Look, Task, Told

AT = "--photos"
LIKE = 0.02
"""Proportions that differ by less than this share are the same."""
WHAT_IS_IN_IT = f"a folder of photographs holds {IDLE}, the photographs and {LABELS}"


@dataclass(frozen=True, kw_only=True, slots=True)
class PhotoFolder:
    """A folder whose table has been read; images are read when they are asked for."""

    folder: Path
    rows: tuple[dict[str, str], ...]
    columns: tuple[str, ...]

    @classmethod
    def open(cls, folder: Path) -> PhotoFolder:
        """Read the table of a folder.

        Raises:
            DesignError: If there is no folder, no photograph at rest, or no table that can be read.
        """
        if not folder.is_dir():
            raise DesignError(f"there is no folder {folder}", hint=WHAT_IS_IN_IT, at=AT)
        if not (folder / IDLE).is_file():
            raise DesignError(
                f"{folder} has no {IDLE}",
                hint="photograph the untouched sensor by the same camera in the same light",
                at=AT,
            )
        rows = _table(folder) if (folder / LABELS).exists() else _by_folder(folder)
        if not rows:
            raise DesignError(f"{folder} names no photographs", hint=WHAT_IS_IN_IT, at=AT)
        return cls(folder=folder, rows=tuple(rows), columns=tuple(rows[0]))

    def seen(self, task: Task, view: View, camera: Camera) -> Iterator[Seen]:
        """The examples of a task.

        Args:
            task: Says which columns must be there.
            view: Says which part of an image is seen.
            camera: Of the design.

        Raises:
            DesignError: Naming file, column and remedy, if something is missing or wrong.
        """
        self._expect_columns(task)
        images = _Images(self.folder, camera)
        numbers = columns_of(task, self.columns) if task.told is Told.VALUES else ()
        groups = _sequences(self.rows) if task.look is Look.WINDOW else [[row] for row in self.rows]
        for rows in groups:
            last = rows[-1]
            shots = [images.photo(row) for row in rows]
            labels: dict[str, str | float] = dict(last)
            for name in numbers:
                labels[name] = _number(last, name)
            if task.look is Look.WINDOW:
                labels[SLIP] = _flag(last)
            yield Seen(
                name=last[PHOTO],
                place=last.get(PLACE, ""),
                change=change(shots, images.idle(last), view),
                motion=motion(shots),
                labels=labels,
            )

    def _expect_columns(self, task: Task) -> None:
        wanted = [SLIP, SEQUENCE, FRAME] if task.look is Look.WINDOW else list(task.columns)
        if task.told is Told.VALUES:
            if not columns_of(task, self.columns):
                self._lacks(" or ".join(f"{name}*" if name[-1] == "_" else name for name in wanted))
            return
        for name in wanted:
            if name not in self.columns:
                self._lacks(name)

    def _lacks(self, column: str) -> None:
        where = self.folder / LABELS
        if not where.exists():
            raise DesignError(
                f"{self.folder} has no {LABELS} with the column {column}",
                hint=f"write {LABELS} with the columns {PHOTO} and {column}",
                at=AT,
            )
        raise DesignError(
            f"{where} has no column {column}",
            hint=f"add it; there are {', '.join(self.columns)}",
            at=AT,
        )


class _Images:
    """Photographs of one size, in the proportion of a camera; those at rest are kept."""

    def __init__(self, folder: Path, camera: Camera) -> None:
        self._folder = folder
        self._rest: dict[str, np.ndarray] = {}
        self._idle = self._read(IDLE)
        self._rest[""] = self._idle
        height, width = self._idle.shape[:2]
        own = camera.width_px / camera.height_px
        if abs(width / height / own - 1.0) > LIKE:
            raise DesignError(
                f"{folder / IDLE} has {width} x {height} pixels, the camera of the design "
                f"{camera.width_px} x {camera.height_px}: another proportion",
                hint="cut or scale the photographs to the camera's view, or set the design's "
                "optics.camera to that which took them",
                at=AT,
            )

    def photo(self, row: dict[str, str]) -> np.ndarray:
        """The photograph of a line, shape (H, W, 3), uint8."""
        return self._sized(row[PHOTO])

    def idle(self, row: dict[str, str]) -> np.ndarray:
        """The one at rest that belongs to it."""
        name = row.get(OWN_IDLE, "")
        if name not in self._rest:
            self._rest[name] = self._sized(name)
        return self._rest[name]

    def _sized(self, name: str) -> np.ndarray:
        found = self._read(name)
        if found.shape != self._idle.shape:
            raise DesignError(
                f"{self._folder / name} has {found.shape[1]} x {found.shape[0]} pixels, {IDLE} "
                f"{self._idle.shape[1]} x {self._idle.shape[0]}",
                hint="take all photographs with the same settings of the camera",
                at=AT,
            )
        return found

    def _read(self, name: str) -> np.ndarray:
        path = self._folder / name
        try:
            return decoded(name, path.read_bytes())
        except (OSError, ValueError) as error:
            raise DesignError(
                f"cannot read {path}: {getattr(error, 'strerror', None) or error}",
                hint=f"correct the name in {LABELS}, or put the photograph there",
                at=AT,
            ) from error


def _table(folder: Path) -> list[dict[str, str]]:
    path = folder / LABELS
    try:
        reader = csv.DictReader(io.StringIO(path.read_bytes().decode("utf-8-sig")))
        columns = [name.strip() for name in reader.fieldnames or ()]
        lines = [
            {name.strip(): (value or "").strip() for name, value in row.items() if name}
            for row in reader
        ]
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise DesignError(
            f"{path} cannot be read: {error}", hint="save it as UTF-8 CSV", at=AT
        ) from error
    if PHOTO not in columns:
        raise DesignError(
            f"{path} has no column {PHOTO}",
            hint=f"its first line names the columns, {PHOTO} among them",
            at=AT,
        )
    return [row for row in lines if row.get(PHOTO)]


def _by_folder(folder: Path) -> list[dict[str, str]]:
    """Photographs in folders that name their class."""
    return [
        {PHOTO: path.relative_to(folder).as_posix(), OBJECT: path.parent.name}
        for path in sorted(folder.glob("*/*"))
        if path.suffix.lower() in PICTURE_ENDINGS and path.stem != "idle"
    ]


def _sequences(rows: Sequence[dict[str, str]]) -> list[list[dict[str, str]]]:
    """The photographs of each sequence in order, the last eight of it."""
    found: dict[str, list[dict[str, str]]] = {}
    for row in rows:
        if row.get(SEQUENCE):
            found.setdefault(row[SEQUENCE], []).append(row)
    for name, members in found.items():
        if len(members) < FRAMES:
            raise DesignError(
                f"the sequence {shown(name)} has {len(members)} photographs, fewer than {FRAMES}",
                hint="take more of it, or leave it out",
                at=AT,
            )
        members.sort(key=lambda row: _number(row, FRAME))
    return [members[-FRAMES:] for members in found.values()]


def _number(row: dict[str, str], name: str) -> float:
    text = row.get(name, "")
    try:
        value = float(text)
    except ValueError:
        value = np.nan
    if not np.isfinite(value):
        raise DesignError(
            f"{row[PHOTO]}: {name} is {shown(text)}, not a number",
            hint=f"correct {LABELS}, or take the line out",
            at=AT,
        )
    return value


def _flag(row: dict[str, str]) -> float:
    value = _number(row, SLIP)
    if value not in (0.0, 1.0):
        raise DesignError(
            f"{row[PHOTO]}: {SLIP} is {value:g}, neither 0 nor 1", hint=f"correct {LABELS}", at=AT
        )
    return value
