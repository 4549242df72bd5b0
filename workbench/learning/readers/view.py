"""One view: what a built sensor shows of one state of its skin. Blocks of them are files.

Only the box of pixels that differ from the sensor at rest is kept, which loses nothing.
"""

from __future__ import annotations

import io
import json
import zipfile
import zlib
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sim.reading.shown_press import ShownPress
from workbench.core.base.errors import StoreError

LEVEL = 1
"""Of compression: what is kept is small, and many are read."""
HEAD = "head"
MAPS = ("photo", "depth_mm", "surface_mm", "turn", "pressure_MPa")


@dataclass(frozen=True, kw_only=True, slots=True)
class View:
    """Of an image of H x W pixels the box of h x w that changed."""

    look: int
    """Which built sensor."""
    name: str
    """The press it shows."""
    solved: bool
    """Whether pressure and force are known."""
    force_N: np.ndarray
    """On the membrane, shape (3,), float32."""
    box: tuple[int, int, int, int]
    """First and last row, first and last column, the last ones not in it."""
    photo: np.ndarray
    """Grey levels, shape (h, w, 3), uint8."""
    depth_mm: np.ndarray
    """Shape (h, w), float16; NaN where no skin is seen."""
    surface_mm: np.ndarray
    """Shape (h, w), float16."""
    turn: np.ndarray
    """Shape (h, w, 3), float16."""
    pressure_MPa: np.ndarray
    """Shape (h, w), float16."""


def view_of(
    shown: ShownPress,
    rest: tuple[np.ndarray, np.ndarray],
    *,
    look: int,
    name: str,
    force_N: np.ndarray | None,
) -> View:
    """A view of what a camera shows.

    Args:
        shown: What it shows.
        rest: Its photograph at rest, (H, W, 3), and the pixels that see skin then, (H, W), bool.
        look: Its number.
        name: Of what is shown.
        force_N: On the membrane, shape (3,); None where nobody knows.
    """
    idle, sees = rest
    hidden = np.isnan(shown.depth_mm) & sees
    changed = (shown.photo != idle).any(axis=2) | shown.turn.any(axis=2) | hidden
    changed |= (np.nan_to_num(shown.depth_mm) != 0.0) | (shown.surface_mm != 0.0)
    rows, columns = np.flatnonzero(changed.any(axis=1)), np.flatnonzero(changed.any(axis=0))
    box = (0, 0, 0, 0)
    if len(rows):
        box = (int(rows[0]), int(rows[-1]) + 1, int(columns[0]), int(columns[-1]) + 1)
    cut = (slice(box[0], box[1]), slice(box[2], box[3]))
    return View(
        look=look,
        name=name,
        solved=force_N is not None,
        force_N=np.zeros(3, np.float32) if force_N is None else force_N.astype(np.float32),
        box=box,
        photo=shown.photo[cut],
        depth_mm=shown.depth_mm[cut].astype(np.float16),
        surface_mm=shown.surface_mm[cut].astype(np.float16),
        turn=shown.turn[cut].astype(np.float16),
        pressure_MPa=shown.pressure_MPa[cut].astype(np.float16),
    )


def look_name(look: int) -> str:
    """File of a built sensor at rest."""
    return f"look-{look:02d}.npz"


def look_bytes(idle: np.ndarray, sees: np.ndarray) -> bytes:
    """The file of a built sensor at rest.

    Args:
        idle: Its photograph, shape (H, W, 3), uint8.
        sees: Pixels that see skin, shape (H, W), bool.
    """
    buffer = io.BytesIO()
    np.savez_compressed(buffer, idle=idle, sees=sees)
    return buffer.getvalue()


def block_bytes(views: Sequence[View]) -> bytes:
    """The file of some views."""
    head = [
        {
            "look": view.look,
            "name": view.name,
            "solved": view.solved,
            "force_N": view.force_N.tolist(),
            "box": view.box,
        }
        for view in views
    ]
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED, compresslevel=LEVEL) as file:
        file.writestr(HEAD, json.dumps(head))
        for name in MAPS:
            parts = [getattr(view, name).ravel() for view in views]
            file.writestr(name, np.concatenate(parts).tobytes())
    return buffer.getvalue()


def block_from(content: bytes, source: str) -> list[View]:
    """The views of a file.

    Raises:
        StoreError: If it is damaged.
    """
    try:
        with zipfile.ZipFile(io.BytesIO(content)) as file:
            rows = json.loads(file.read(HEAD))
            flat = {
                name: np.frombuffer(file.read(name), np.uint8 if name == "photo" else np.float16)
                for name in MAPS
            }
        return _views(rows, flat)
    except (KeyError, TypeError, ValueError, zlib.error, zipfile.BadZipFile) as error:
        raise StoreError(
            f"the views {source} are damaged: {error}",
            hint="delete the file and train again: it is made anew",
            at=source,
        ) from error


def _views(rows: list[dict], flat: dict[str, np.ndarray]) -> list[View]:
    found, start = [], 0
    for row in rows:
        top, bottom, left, right = row["box"]
        shape = (bottom - top, right - left)
        count = shape[0] * shape[1]
        maps = {}
        for name in MAPS:
            deep = 3 if name in ("photo", "turn") else 1
            values = flat[name][start * deep : (start + count) * deep]
            maps[name] = values.reshape(*shape, 3) if deep == 3 else values.reshape(shape)
        start += count
        force_N = np.array(row["force_N"], np.float32)
        given = {"look": row["look"], "name": row["name"], "solved": row["solved"]}
        found.append(View(**given, force_N=force_N, box=(top, bottom, left, right), **maps))
    return found
