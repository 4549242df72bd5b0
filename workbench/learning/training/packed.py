"""Data sets packed for training: one file with the fields alone, lossless, a tenth of the size.

For machines that a data set with images is too large to be sent to, and to open quickly. A file is
a compressed NPZ: `head` is JSON, the rest arrays. It is written whole, and refused if its content
is not what its head says.
"""

from __future__ import annotations

import dataclasses
import io
import json
import zipfile
import zlib
from pathlib import Path
from typing import Any

import numpy as np

from workbench.core.base.errors import StoreError
from workbench.learning.dataset.cases import Split
from workbench.learning.training.presses import Presses, RestSkin, SparseField, State
from workbench.system.whole_files import write_atomically

FORMAT = 2
SUFFIX = ".presses"


def write_packed(path: Path, presses: Presses) -> None:
    """Write what training needs into one file.

    Raises:
        StoreError: If it cannot be written.
    """
    head = {
        "format": FORMAT,
        "key": presses.key,
        "parts": sorted(presses.parts),
        "states": [dataclasses.astuple(state) for state in presses.states],
        "about": dict(presses.about),
        "skins": [{"mesh": skin.mesh, "design": dict(skin.design)} for skin in presses.skins],
    }
    arrays: dict[str, Any] = {"head": np.frombuffer(json.dumps(head).encode(), np.uint8)}
    for number, skin in enumerate(presses.skins):
        arrays |= {f"points_mm.{number}": skin.points_mm, f"faces.{number}": skin.faces}
    for name, field in presses.parts.items():
        arrays |= {f"{name}.{f.name}": getattr(field, f.name) for f in dataclasses.fields(field)}
    buffer = io.BytesIO()
    np.savez_compressed(buffer, **arrays)
    write_atomically(path, buffer.getvalue())


def read_packed(path: Path) -> Presses:
    """Read a packed file.

    Raises:
        StoreError: If it is none, damaged, cut short, or of another format.
    """
    try:
        with np.load(path) as file:
            arrays = {name: file[name] for name in file.files}
        head = json.loads(arrays["head"].tobytes())
        if head["format"] != FORMAT:
            raise ValueError(f"it has format {head['format']!r}, this program reads {FORMAT}")
        presses = Presses(
            skins=tuple(
                RestSkin(
                    points_mm=arrays[f"points_mm.{number}"],
                    faces=arrays[f"faces.{number}"],
                    mesh=skin["mesh"],
                    design=skin["design"],
                )
                for number, skin in enumerate(head["skins"])
            ),
            states=tuple(_state(row) for row in head["states"]),
            parts={
                name: SparseField(
                    **{f.name: arrays[f"{name}.{f.name}"] for f in dataclasses.fields(SparseField)}
                )
                for name in head["parts"]
            },
            about=head["about"],
        )
        if presses.key != head["key"]:
            raise ValueError("its content is not what was written")
    except (OSError, KeyError, TypeError, ValueError, EOFError, zlib.error) as error:
        raise _refused(path, str(error)) from error
    except zipfile.BadZipFile as error:
        raise _refused(path, f"it is cut short or damaged: {error}") from error
    return presses


def _state(row: list[Any]) -> State:
    values = dict(zip((f.name for f in dataclasses.fields(State)), row, strict=True))
    return State(**{**values, "split": Split(values["split"])})


def _refused(path: Path, why: str) -> StoreError:
    return StoreError(
        f"the packed data {path} cannot be used: {why}",
        hint="pack the data sets again with workbench train pack",
        at=str(path),
    )
