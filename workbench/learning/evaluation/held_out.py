"""A held-out set: the samples that no training looks at, small enough to ship with the program.

One NPZ file, written by `packing`. `head` is JSON: format, recipe with its key, the cases and what
each sample holds. Vectors are whole numbers of 16 bits in steps of 1/32767 of the largest number of
their sample and field, so that rounding moves a value by at most 1.5e-5 of that; high and low bytes
lie apart, which packs better. Vertices that round to rest are left out.

Left out: images, stress, slip, and what the solvers say about themselves.
"""

from __future__ import annotations

import io
import json
import zipfile
import zlib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from sim.forces.network.spec import FIELDS, Target
from workbench.core.base.digest import digest
from workbench.core.base.errors import StoreError
from workbench.learning.dataset.cases import Case, Split, case_of_row
from workbench.learning.dataset.folder import SkinData
from workbench.learning.dataset.recipe import table_key
from workbench.learning.dataset.sample import Sample, Solved
from workbench.view.scene_shapes import corner_normals

FORMAT = 1
STEPS = 32767
"""Whole numbers from zero to the largest value."""
PARTS = tuple(FIELDS.values())
SOLVERS = ("mpm", "fem")


class HeldOut:
    """A held-out set that was read."""

    def __init__(
        self, head: dict[str, Any], skin: SkinData, arrays: dict[str, np.ndarray], name: str
    ) -> None:
        self.manifest = head
        self.skin = skin
        self.name = name
        self._arrays = arrays
        self._cases = [case_of_row(row) for row in head["cases"]]
        self._rows = {
            (row["case"], row["frame"]): (number, row) for number, row in enumerate(head["samples"])
        }
        self._ends = {
            part: np.concatenate([[0], np.cumsum(arrays[f"{part}.counts"])]) for part in PARTS
        }

    @classmethod
    def open(cls, path: Path) -> HeldOut:
        """Read a held-out set.

        Raises:
            StoreError: If there is none, it is damaged, or of another format.
        """
        try:
            with np.load(io.BytesIO(path.read_bytes())) as file:
                arrays = {name: file[name] for name in file.files}
            head = json.loads(arrays.pop("head").tobytes())
            if head["format"] != FORMAT:
                raise ValueError(f"it has format {head['format']}, this program reads {FORMAT}")
            if table_key(head["recipe"]) != head["key"]:
                raise ValueError("its recipe is not the one that it was made from")
            if content_digest(head, arrays) != head["content"]:
                raise ValueError("its content is not what was written")
            skin = _skin(arrays.pop("points_mm"), arrays.pop("faces"), arrays.pop("areas_mm2"))
            return cls(head, skin, arrays, str(path))
        except OSError as error:
            raise _unusable(path, str(error.strerror or error)) from error
        except (KeyError, TypeError, ValueError, EOFError, zlib.error) as error:
            raise _unusable(path, str(error)) from error
        except zipfile.BadZipFile as error:
            raise _unusable(path, f"it is truncated or damaged: {error}") from error

    @property
    def key(self) -> str:
        """Key of the recipe."""
        return self.manifest["key"]

    def cases(self, split: Split | None = None) -> list[Case]:
        """The cases of one split, or all."""
        return [case for case in self._cases if split in (None, case.split)]

    def frames(self, case: Case) -> list[int]:
        """Frames of a case that were kept."""
        return [frame for name, frame in self._rows if name == case.id]

    def sample(self, case: Case, frame: int) -> Sample:
        """One sample, as far as it was kept.

        Raises:
            StoreError: If it was not.
        """
        if (case.id, frame) not in self._rows:
            raise _unusable(Path(self.name), f"frame {frame + 1} of {case.id} is not in it")
        number, row = self._rows[case.id, frame]
        solved = {solver: self._solved(number, row, where) for where, solver in enumerate(SOLVERS)}
        return Sample(
            case=case.id,
            frame=frame,
            recipe=self.key,
            indenter=case.indenter.value,
            depth_mm=case.depth_at(frame),
            shear_mm=case.shear_at(frame),
            pose=np.array(row["pose"]),
            target_mm=np.array(row["target_mm"]),
            normal=np.array(row["normal"]),
            tangent_u=np.array(row["tangent_u"]),
            mpm=solved["mpm"],
            fem=solved["fem"],
        )

    def _solved(self, number: int, row: dict[str, Any], where: int) -> Solved:
        fields, largest = {}, row["largest"]
        for part in PARTS:
            first, end = self._ends[part][number : number + 2]
            steps = np.cumsum(self._arrays[f"{part}.steps"][first:end].astype(np.int64))
            high, low = self._arrays[f"{part}.bytes"][:, first:end, where]
            values = (high.astype(np.uint16) << 8 | low).view(np.int16)
            field = np.zeros((len(self.skin.points_mm), 3), np.float32)
            field[steps] = values * np.float32(largest[f"{SOLVERS[where]}.{part}"] / STEPS)
            fields[part] = field
        return Solved(
            **fields,
            sliding=np.zeros(len(self.skin.points_mm), bool),
            reaction_N=-fields[FIELDS[Target.FORCE]].sum(axis=0, dtype=np.float64),
            tangential_N=0.0,
            residual=0.0,
            balance=0.0,
            converged=True,
            seconds=0.0,
        )


def content_digest(head: Mapping[str, Any], arrays: Mapping[str, np.ndarray]) -> str:
    """Digest of all that a file holds, but for itself."""
    fields = {name: value for name, value in head.items() if name != "content"}
    return digest([json.dumps(fields, sort_keys=True), *(arrays[name] for name in sorted(arrays))])


def _skin(points_mm: np.ndarray, faces: np.ndarray, areas_mm2: np.ndarray) -> SkinData:
    normals = corner_normals(points_mm, faces)
    return SkinData(points_mm=points_mm, faces=faces, normals=normals, areas_mm2=areas_mm2)


def _unusable(path: Path, why: str) -> StoreError:
    return StoreError(
        f"the held-out set {path} cannot be used: {why}",
        hint="make it again with workbench evaluate DATA --pack FILE",
        at=str(path),
    )
