"""Trajectories as CSV files: one row per pose, in the columns `COLUMNS`, read and written.

    t_s,x_mm,y_mm,z_mm,qw,qx,qy,qz
    0.0,0.0,0.0,46.0,1,0,0,0
    0.1,0.0,0.0,44.5,1,0,0,0

The header is needed, the order of the columns is free, further columns are ignored with a notice.
Every run writes the poses of its press in the same form, so that they can be read back. Speed is
not part of it: a press has no times, and its frames count as seconds.
"""

from __future__ import annotations

import csv
import io
import math
from pathlib import Path

import numpy as np

from workbench.core.base.errors import DesignError, shown
from workbench.core.base.mapping import suggest
from workbench.core.base.poses import composed, inverses, sensor_poses
from workbench.core.press.motion import Mover
from workbench.core.press.press import Press
from workbench.core.press.trajectory import COLUMNS, MOST_ROWS, Trajectory
from workbench.core.result.sensing import Contact
from workbench.system.uploads import uploaded_file

LARGEST_BYTES = 16_000_000
AT = "press.trajectory"
FORM = f"the first line must read {','.join(COLUMNS)}"


def read_trajectory(path: Path, *, every_s: float = 0.0) -> Trajectory:
    """A trajectory from a CSV file.

    Args:
        path: The file.
        every_s: Time from frame to frame [s]; 0 makes a frame of every row but the first.

    Raises:
        DesignError: Naming file, row and column of what is wrong.
    """
    rows = _rows(path)
    header = [name.strip() for name in rows[0][1]] if rows else []
    places = _columns(path, header)
    table = [
        [_number(path, row, line, cells, header, place) for place in places]
        for row, (line, cells) in enumerate(rows[1:], start=1)
    ]
    if len(table) < 2:
        raise DesignError(
            f"{path.name} has {len(table)} rows of poses; a trajectory needs at least 2",
            hint="the first row is where the path starts, each further one is a frame",
            at=AT,
        )
    if len(table) > MOST_ROWS:
        raise DesignError(
            f"{path.name} has {len(table):,} rows; the limit is {MOST_ROWS:,}",
            hint="leave rows out; the way between two rows is straight",
            at=AT,
        )
    extra = [name for name in header if name not in COLUMNS]
    notice = f"{path.name}: ignored column {', '.join(map(repr, extra))}" if extra else ""
    try:
        return Trajectory(
            times_s=tuple(row[0] for row in table),
            poses=tuple((x, y, z, qw, qx, qy, qz) for _, x, y, z, qw, qx, qy, qz in table),
            every_s=every_s,
            notice=notice,
        )
    except DesignError as error:
        raise DesignError(f"{path.name}, {error.message}", hint=error.hint, at=error.at) from error


def uploaded_trajectory(name: str, content: bytes) -> Trajectory:
    """A trajectory from a file of the browser.

    Raises:
        DesignError: If it is too large, or as `read_trajectory`.
    """
    hint = f"a trajectory has at most {MOST_ROWS:,} rows"
    with uploaded_file(name, content, limit_bytes=LARGEST_BYTES, hint=hint, at=AT) as path:
        return read_trajectory(path)


def _rows(path: Path) -> list[tuple[int, list[str]]]:
    """Line number and cells of every line that is not empty."""
    try:
        if path.stat().st_size > LARGEST_BYTES:
            raise DesignError(
                f"{path.name} has {path.stat().st_size / 1e6:,.0f} MB, more than "
                f"{LARGEST_BYTES / 1e6:g} MB",
                hint=f"a trajectory has at most {MOST_ROWS:,} rows",
                at=AT,
            )
        text = path.read_text(encoding="utf-8-sig")
        reader = csv.reader(io.StringIO(text, newline=""))
        return [(reader.line_num, row) for row in reader if any(cell.strip() for cell in row)]
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        reason = getattr(error, "strerror", None) or error
        raise DesignError(
            f"the trajectory {shown(str(path))} cannot be read: {reason}",
            hint=f"give a CSV file; {FORM}",
            at=AT,
        ) from error


def _columns(path: Path, header: list[str]) -> list[int]:
    """Where each of `COLUMNS` stands in the header."""
    for name in COLUMNS:
        if header.count(name) != 1:
            state = "twice" if header.count(name) else "missing"
            separated = len(header) == 1 and ";" in header[0]
            remedy = "separate the columns by commas" if separated else FORM
            near = suggest(name, header) if header else ""
            likely = f"; {near}" if near.startswith("did you mean") else ""
            raise DesignError(
                f"{path.name}: the column {name} is {state}", hint=f"{remedy}{likely}", at=AT
            )
    return [header.index(name) for name in COLUMNS]


def _number(
    path: Path, row: int, line: int, cells: list[str], header: list[str], place: int
) -> float:
    text = cells[place].strip() if place < len(cells) else ""
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise DesignError(
            f"{path.name}, row {row} (line {line}), column {header[place]}: {shown(text)} is not a "
            "finite number",
            hint="write plain numbers with a point, for example -1.25",
            at=AT,
        )
    return value


def press_poses(press: Press, contact: Contact) -> tuple[np.ndarray, np.ndarray]:
    """Times [s], (K + 1,), and poses, (K + 1, 7), of what moved, from the start of the path on."""
    poses = np.concatenate([_start(press, contact)[None], contact.indenter_pose])
    if press.mover is Mover.SENSOR:
        first = np.array([0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0])
        if press.trajectory is not None:
            first = np.array(press.trajectory.poses[0])
        poses = sensor_poses(poses, first)
    # A run that stopped early has fewer frames than its press.
    return press.times_s()[: len(poses)], poses


def _start(press: Press, contact: Contact) -> np.ndarray:
    """Pose of the object in the sensor frame before the first frame, shape (7,)."""
    after = contact.indenter_pose[0]
    if press.trajectory is None:
        way_mm = press.depth_mm / press.frames
        return np.concatenate([after[:3] + way_mm * contact.normal, after[3:]])
    rows = press.trajectory.at_progress(np.array([0.0, 1.0]))
    if press.mover is Mover.OBJECT:
        return rows[0]
    # The object stands in the room: the same place seen from the sensor's first pose.
    return composed(inverses(rows[:1]), composed(rows[1:], after[None]))[0]


def pose_csv(times_s: np.ndarray, poses: np.ndarray) -> str:
    """Times [s], (K,), and poses, (K, 7), as the text of a CSV file, every digit kept."""
    table = np.column_stack([times_s, poses])
    lines = [",".join(repr(float(number)) for number in row) for row in table]
    return "\n".join([",".join(COLUMNS), *lines, ""])
