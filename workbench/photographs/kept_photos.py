"""The photographs of a calibration as a project keeps them: what was put in, and corrected by hand.

They lie in `calibration/photos` as `workbench calibrate` reads them: `idle.png`, the photographs
and `presses.csv`, which names those that are not left out. `set.json` beside it says the rest: what
each photograph is used for, and why no contact was found in it. All is written at once, so that a
crash loses nothing.
"""

from __future__ import annotations

import csv
import dataclasses
import io
import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from pathlib import Path
from typing import Any

import numpy as np

from workbench.calibration.seen.drift import NO_DRIFT, Drift
from workbench.calibration.seen.photo_set import CIRCLE, COLUMNS, FEWEST, IDLE, POSE, TABLE, Circle
from workbench.core.base.errors import DesignError
from workbench.photographs.photo_files import decoded, is_idle, number, table_lines
from workbench.report.image_files import png_bytes
from workbench.system.whole_files import free_path, write_atomically

FOLDER, PHOTOS, SET = "calibration", "photos", "set.json"
KNOWN = ("depth_mm", "force_N")


class Use(StrEnum):
    """What a photograph is for."""

    FIT = "fit to it"
    HOLD = "hold it out as a test"
    LEAVE = "leave it out"


@dataclass(frozen=True, kw_only=True, slots=True)
class KeptPhoto:
    """One photograph and what is known of it."""

    photo: str
    ball_mm: float
    """Diameter."""
    circle: Circle | None = None
    """Of the contact: typed, or found."""
    by_hand: bool = False
    """Whether the circle was given rather than found."""
    place_mm: tuple[float, float, float] | None = None
    """Where on the skin at rest a stage pressed the ball, in the sensor frame."""
    depth_mm: float | None = None
    force_N: float | None = None
    use: Use = Use.FIT
    reason: str = ""
    """Why no contact was found; empty where it was, or was not looked for."""
    drift: Drift = field(default=NO_DRIFT, compare=False)
    """From rest's exposure."""


class KeptPhotos:
    """The set of one project."""

    def __init__(self, project: Path) -> None:
        self.root = project / FOLDER
        self.photos: tuple[KeptPhoto, ...] = ()
        self.load()

    @property
    def folder(self) -> Path:
        """Where the photographs lie."""
        return self.root / PHOTOS

    @property
    def out(self) -> Path:
        """Where the calibration is written."""
        return self.root / "out"

    @property
    def has_idle(self) -> bool:
        """Whether there is a photograph at rest."""
        return (self.folder / IDLE).is_file()

    @property
    def fitted(self) -> tuple[KeptPhoto, ...]:
        """Those that are fitted to."""
        return tuple(each for each in self.photos if each.use is Use.FIT)

    @property
    def held_out(self) -> tuple[str, ...]:
        """Names of those that are predicted only."""
        return tuple(each.photo for each in self.photos if each.use is Use.HOLD)

    def image(self, name: str) -> np.ndarray:
        """A photograph, shape (H, W, 3), uint8.

        Raises:
            DesignError: If it is gone or cannot be read.
        """
        try:
            return decoded(name, (self.folder / name).read_bytes())
        except OSError as error:
            raise DesignError(f"{name} cannot be read: {error}", hint="load it again") from error

    def load(self) -> None:
        """Read what is kept; photographs that nothing is written of are none of the set."""
        try:
            rows = json.loads((self.root / SET).read_text(encoding="utf-8"))
            found = tuple(_from_row(row) for row in rows)
        except (OSError, ValueError, KeyError, TypeError):
            found = ()
        self.photos = tuple(each for each in found if (self.folder / each.photo).is_file())

    def take(self, files: Mapping[str, bytes], ball_mm: float) -> tuple[str, ...]:
        """Add files by name: pictures, `idle.png` among them, and a table; all of them or none.

        Args:
            files: Contents by name. `idle` with any ending is the photograph at rest.
            ball_mm: Diameter of the ball where no table says one.

        Returns:
            Names of the photographs that came.

        Raises:
            DesignError: With the file's name, if it cannot be read or has another size.
            StoreError: If the folder cannot be written.
        """
        tables = [name for name in files if name.lower().endswith(".csv")]
        pictures = {name: decoded(name, files[name]) for name in files if name not in tables}
        self._expect_one_size(pictures)
        rows: dict[str, dict[str, str]] = {}
        for name in tables:
            rows |= table_lines(name, files[name])
        known = {each.photo: each for each in self.photos}
        for name in pictures:
            if not is_idle(name):
                known[name] = KeptPhoto(photo=name, ball_mm=ball_mm)
        known = {
            name: _told(each, rows[name]) if name in rows else each for name, each in known.items()
        }
        for name, image in pictures.items():
            # The photograph at rest is PNG for the command line, whatever it came as.
            kept = files[name] if name.lower().endswith(".png") else png_bytes(image)
            path = IDLE if is_idle(name) else name
            write_atomically(self.folder / path, kept if is_idle(name) else files[name])
        self.photos = tuple(known[name] for name in sorted(known))
        if any(is_idle(name) for name in pictures):
            # Contacts are told by their difference from it.
            self.photos = tuple(_unfound(each) for each in self.photos)
        self.save()
        return tuple(name for name in pictures if not is_idle(name))

    def put(self, *changed: KeptPhoto) -> None:
        """Replace what is known of photographs by their names."""
        new = {each.photo: each for each in changed}
        self.photos = tuple(new.get(each.photo, each) for each in self.photos)
        self.save()

    def save(self) -> None:
        """Write the set, and the table as the command line reads it."""
        rows = [_to_row(each) for each in self.photos]
        write_atomically(self.root / SET, json.dumps(rows, indent=1).encode())
        text = io.StringIO()
        table = csv.writer(text, lineterminator="\n")
        table.writerow(COLUMNS)
        table.writerows(_line(each) for each in self.photos if each.use is not Use.LEAVE)
        write_atomically(self.folder / TABLE, text.getvalue().encode())

    def put_away(self) -> Path | None:
        """Begin anew: the set is kept beside under another name, which is returned."""
        if not self.root.exists():
            return None
        kept = free_path(self.root.with_name(f"{FOLDER}-before"))
        self.root.replace(kept)
        self.photos = ()
        return kept

    def expect_ready(self) -> None:
        """Refuse a set that cannot be calibrated to.

        Raises:
            DesignError: Saying what it lacks.
        """
        if not self.has_idle:
            raise DesignError(
                "there is no idle photo", hint="load the sensor with nothing on it as idle.png"
            )
        if len(self.fitted) < FEWEST:
            raise DesignError(
                f"{len(self.fitted)} photographs to fit to are fewer than {FEWEST}",
                hint="load more photographs of balls, 10 to 20 are good, or hold fewer out",
            )
        bare = [e.photo for e in self.photos if e.use is not Use.LEAVE and e.circle is None]
        if bare:
            raise DesignError(
                f"{', '.join(bare)}: no contact is known",
                hint="type its column, row and radius, find it again, or leave the photograph out",
            )

    def _expect_one_size(self, pictures: Mapping[str, np.ndarray]) -> None:
        """Refuse pictures of another size than the one at rest, or than the first."""
        sizes = {name: image.shape[1::-1] for name, image in pictures.items()}
        first = next((name for name in sizes if is_idle(name)), "")
        if not first:
            there = [IDLE] * self.has_idle + [each.photo for each in self.photos]
            if there:
                first = there[0]
                sizes[first] = self.image(first).shape[1::-1]
        else:
            sizes |= {each.photo: self.image(each.photo).shape[1::-1] for each in self.photos}
        first = first or next(iter(sizes), "")
        for name, (width, height) in sizes.items():
            if (width, height) != sizes[first]:
                raise DesignError(
                    f"{name} has {width} x {height} pixels, {first} {sizes[first][0]} x "
                    f"{sizes[first][1]}",
                    hint="take all photographs with the same settings of the camera",
                )


def _unfound(each: KeptPhoto) -> KeptPhoto:
    circle = each.circle if each.by_hand else None
    return dataclasses.replace(each, circle=circle, reason="", drift=NO_DRIFT)


def _told(each: KeptPhoto, line: Mapping[str, str]) -> KeptPhoto:
    """A photograph with what the table says of it.

    Raises:
        DesignError: If a value is no number, or says nothing without one that is empty.
    """
    values = {name: number(each.photo, name, line.get(name)) for name in COLUMNS[1:]}
    drawn = _together(each.photo, "a circle", {name: values[name] for name in CIRCLE})
    place = _together(each.photo, "a pose", {name: values[name] for name in POSE})
    return dataclasses.replace(
        each,
        ball_mm=values["ball_mm"] or each.ball_mm,
        circle=each.circle if drawn is None else Circle(**dict(zip(CIRCLE, drawn, strict=True))),
        by_hand=drawn is not None or each.by_hand,
        place_mm=place,
        **{name: values[name] for name in KNOWN},
    )


def _together(
    photo: str, what: str, values: Mapping[str, float | None]
) -> tuple[float, float, float] | None:
    """Three values that only say something together; None where all of them are empty."""
    if all(value is None for value in values.values()):
        return None
    empty = next((name for name, value in values.items() if value is None), "")
    if empty:
        raise DesignError(
            f"{photo} has {what} without {empty}",
            hint=f"give {', '.join(values)}, or leave all of them empty",
        )
    first, second, third = (float(value or 0.0) for value in values.values())
    return first, second, third


def _line(each: KeptPhoto) -> list[Any]:
    # A circle that was found is found again, and is then not taken for one that was drawn.
    drawn = dataclasses.astuple(each.circle) if each.circle and each.by_hand else ("", "", "")
    known = (each.depth_mm, each.force_N, *(each.place_mm or ("", "", "")))
    return [each.photo, each.ball_mm, *drawn, *("" if value is None else value for value in known)]


def _to_row(each: KeptPhoto) -> dict[str, Any]:
    row = {f.name: getattr(each, f.name) for f in dataclasses.fields(each)}
    row["circle"] = None if each.circle is None else dataclasses.asdict(each.circle)
    row["drift"] = {"gain": each.drift.gain.tolist(), "offset": each.drift.offset.tolist()}
    return row


def _from_row(row: dict[str, Any]) -> KeptPhoto:
    circle, drift = row["circle"], row["drift"]
    values = {
        "use": Use(row["use"]),
        "circle": None if circle is None else Circle(**circle),
        "place_mm": None if row.get("place_mm") is None else tuple(row["place_mm"]),
        "drift": Drift(gain=np.array(drift["gain"]), offset=np.array(drift["offset"])),
    }
    return KeptPhoto(**{**row, **values})
