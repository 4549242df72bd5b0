"""Files of photographs as a designer hands them in: a picture, an archive, a folder, a table."""

from __future__ import annotations

import csv
import io
from pathlib import Path

import numpy as np

from sim.optics.raster.photo_file import read_rgb
from workbench.calibration.seen.photo_set import COLUMNS
from workbench.core.base.errors import DesignError
from workbench.core.design.photo import PICTURE_ENDINGS, photo
from workbench.system.uploads import MOST_BYTES as MOST_UPLOADED
from workbench.system.uploads import check_upload, own_name
from workbench.system.zip_files import zip_members

MOST_FILES, MOST_BYTES = 100, 400_000_000
"""Of an archive, unpacked."""
AT = "photographs"
"""Field of messages."""


def decoded(name: str, data: bytes) -> np.ndarray:
    """A picture file as grey levels, shape (H, W, 3), uint8.

    Raises:
        DesignError: With its name, if it is none.
    """
    values = read_rgb(photo(name, data, at=AT), at=AT, ground=0.0)
    return np.round(255.0 * values).astype(np.uint8)


def unpacked(name: str, content: bytes) -> dict[str, bytes]:
    """The files of an upload by their own names: of an archive, or of one file.

    Raises:
        DesignError: If an archive cannot be read, or holds no picture and no table.
    """
    if not name.lower().endswith(".zip"):
        return {own_name(name): content}
    members = zip_members(
        name, content, wanted=_usable, most_files=MOST_FILES, most_bytes=MOST_BYTES
    )
    if not members:
        raise DesignError(
            f"{own_name(name)} holds no photographs",
            hint="zip idle.png, the photographs and, where there is one, presses.csv",
        )
    return {own_name(path): data for path, data in members.items()}


def unpacked_upload(name: str, content: bytes, *, hint: str) -> dict[str, bytes]:
    """The files of what a browser sent.

    Args:
        name: As it was sent.
        content: Its bytes.
        hint: What to do with a larger one.

    Raises:
        DesignError: If it is too large, or as `unpacked`.
    """
    check_upload(name, content, limit_bytes=MOST_UPLOADED, hint=hint, at=AT)
    return unpacked(name, content)


def folder_files(project: Path, typed: str) -> dict[str, bytes]:
    """The files of a folder that lies in the project.

    Raises:
        DesignError: If it does not lie there, cannot be read or holds no photographs.
    """
    folder = (project / typed).resolve()
    if not typed.strip() or not folder.is_relative_to(project) or not folder.is_dir():
        raise DesignError(
            f"there is no folder {typed.strip() or '(nothing typed)'} in the project",
            hint=f"put it into {project} and type its name, or load a zip",
        )
    try:
        paths = [path for path in sorted(folder.iterdir()) if path.is_file()]
        found = {path.name: path.read_bytes() for path in paths if _usable(path.name)}
    except OSError as error:
        raise DesignError(f"{folder} cannot be read: {error}", hint="check the folder") from error
    if not found:
        raise DesignError(f"{typed} holds no photographs", hint="put idle.png and photographs in")
    return found


def _usable(path: str) -> bool:
    """Whether a member of an archive is a picture or a table, and not a system's own."""
    name = path.rpartition("/")[2]
    return (
        not path.startswith("__MACOSX")
        and not name.startswith(".")
        and name.lower().endswith((*PICTURE_ENDINGS, ".csv"))
    )


def is_idle(name: str) -> bool:
    """Whether a file is the photograph at rest."""
    return Path(name).stem.lower() == "idle"


def table_lines(name: str, data: bytes) -> dict[str, dict[str, str]]:
    """The lines of a table by photograph.

    Raises:
        DesignError: If it cannot be read or has no column of photographs.
    """
    try:
        lines = list(csv.DictReader(io.StringIO(data.decode("utf-8-sig"))))
    except (UnicodeDecodeError, csv.Error) as error:
        raise DesignError(f"{name} is no table: {error}", hint="save it as UTF-8 CSV") from error
    if not lines or COLUMNS[0] not in lines[0]:
        raise DesignError(
            f"{name} has no column {COLUMNS[0]}", hint=f"its first line is {','.join(COLUMNS)}"
        )
    return {(line[COLUMNS[0]] or "").strip(): line for line in lines}


def number(photo: str, name: str, text: str | None) -> float | None:
    """A number of the table; None where its place is empty.

    Raises:
        DesignError: If it is no number.
    """
    if not (text or "").strip():
        return None
    try:
        return float(text or "")
    except ValueError as error:
        raise DesignError(
            f"{photo}: {name} is {text}, not a number", hint="correct the table"
        ) from error
