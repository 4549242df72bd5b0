"""A held-out set: the samples that no training looks at, small enough to ship with the program.

One NPZ file. `head` is JSON: format, recipe with its key, the cases and what each sample holds.
Vectors are whole numbers of 16 bits in steps of 1/32767 of the largest number of their sample and
field, so that rounding moves a value by at most 1.5e-5 of that (a tenth of what a good network
errs); high and low bytes lie apart, which packs better. Vertices that round to rest are left out.

`made_from` takes the last frame of the press of each held-out case, the one half as deep, and the
last of its shear; where that is too large for the file, the cases are thinned evenly.
Left out: images, stress, slip, and what the solvers say about themselves. The training and
validation cases of the set it was made from are not in it.
"""

from __future__ import annotations

import io
import json
import zipfile
import zlib
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from sim.forces.network.spec import Target
from workbench import __version__
from workbench.core.digest import digest
from workbench.core.errors import StoreError
from workbench.core.monitor import Monitor, silent
from workbench.dataset.cases import Case, Split, case_of_row, case_row
from workbench.dataset.folder import SkinData, mesh_key
from workbench.dataset.recipe import table_key
from workbench.dataset.sample import Sample, Solved
from workbench.evaluation.scoring import FIELDS, both
from workbench.evaluation.sources import HELD_OUT, Source, expect_held_out, young_MPa
from workbench.previews import corner_normals

FORMAT = 1
STEPS = 32767
"""Whole numbers from zero to the largest value."""
MOST_BYTES = 6_000_000
"""Of a file that ships."""
THINNER = 0.9
"""Share of the fitting number of cases that is tried next."""
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
            if digest([arrays[name] for name in sorted(arrays)]) != head["content"]:
                raise ValueError("its numbers are not those that were written")
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


def made_from(
    source: Source, *, most_bytes: int = MOST_BYTES, name: str, monitor: Monitor = silent
) -> bytes:
    """The file of a held-out set, no larger than asked.

    Raises:
        DesignError: If nothing is held out.
        StoreError: If a sample is damaged or lacks a solver, or one case is too large already.
    """
    chosen = chosen_states(expect_held_out(source, name))
    cases = list(dict.fromkeys(case.id for case, _ in chosen))
    kept = len(cases)
    while True:
        picks = np.unique(np.linspace(0, len(cases) - 1, kept).astype(int))
        ids = {cases[pick] for pick in picks}
        content = _packed(source, [one for one in chosen if one[0].id in ids], monitor)
        if len(content) <= most_bytes:
            return content
        if kept == 1:
            raise StoreError(
                f"one case takes {len(content)} bytes, the limit is {most_bytes}",
                hint="allow a larger file",
                at="--most-mb",
            )
        kept = max(1, min(kept - 1, int(THINNER * kept * most_bytes / len(content))))


def chosen_states(states: Sequence[tuple[Case, int]]) -> list[tuple[Case, int]]:
    """Of each case the last frame of its press, the one half as deep, and the last of its shear."""
    return [
        (case, frame)
        for case, frame in states
        if frame in (case.press_frames // 2 - 1, case.press_frames - 1, case.frames - 1)
    ]


def _packed(source: Source, chosen: Sequence[tuple[Case, int]], monitor: Monitor) -> bytes:
    rows, columns = [], {part: _Column() for part in PARTS}
    for number, (case, frame) in enumerate(chosen):
        monitor(number / len(chosen), case.id)
        sample = source.sample(case, frame)
        solved = both(sample)
        largest: dict[str, float] = {}
        for part, column in columns.items():
            tops = column.add([getattr(one, part) for one in solved])
            largest |= {f"{name}.{part}": top for name, top in zip(SOLVERS, tops, strict=True)}
        placed = ("pose", "target_mm", "normal", "tangent_u")
        rows.append(
            {
                **{name: getattr(sample, name).tolist() for name in placed},
                "case": case.id,
                "frame": frame,
                "largest": largest,
            }
        )
    arrays: dict[str, np.ndarray] = {
        "points_mm": np.asarray(source.skin.points_mm),
        "faces": np.asarray(source.skin.faces),
        "areas_mm2": np.asarray(source.skin.areas_mm2),
    }
    for part, column in columns.items():
        arrays |= {f"{part}.{name}": values for name, values in column.arrays().items()}
    return _file(source, chosen, rows, arrays)


class _Column:
    """One field of all samples and both solvers, as whole numbers."""

    def __init__(self) -> None:
        self.counts: list[int] = []
        self.steps: list[np.ndarray] = []
        self.values: list[np.ndarray] = []

    def add(self, fields: Sequence[np.ndarray]) -> list[float]:
        """Add a sample; returns the largest number of each solver's field."""
        tops = [float(np.abs(field).max(initial=0.0)) for field in fields]
        pairs = zip(fields, tops, strict=True)
        whole = [np.rint(field * (STEPS / (top or 1.0))) for field, top in pairs]
        values = np.stack(whole, axis=1).astype(np.int16)
        index = np.flatnonzero(values.any(axis=(1, 2)))
        self.counts.append(len(index))
        self.steps.append(np.diff(index, prepend=0))
        self.values.append(values[index])
        return tops

    def arrays(self) -> dict[str, np.ndarray]:
        """What the file holds of it."""
        shorts = np.concatenate(self.values).view(np.uint16)
        return {
            "counts": np.array(self.counts, np.int32),
            "steps": np.concatenate(self.steps).astype(np.int32),
            "bytes": np.stack([shorts >> 8, shorts & 0xFF]).astype(np.uint8),
        }


def _file(
    source: Source,
    chosen: Sequence[tuple[Case, int]],
    rows: list[dict[str, Any]],
    arrays: dict[str, np.ndarray],
) -> bytes:
    head = {
        "format": FORMAT,
        "program": __version__,
        "key": source.key,
        "recipe": source.manifest["recipe"],
        "mesh": mesh_key(source.skin),
        "young_MPa": young_MPa(source),
        "splits": [split.value for split in HELD_OUT],
        "cases": list({case.id: case_row(case) for case, _ in chosen}.values()),
        "samples": rows,
        "content": digest([arrays[name] for name in sorted(arrays)]),
    }
    buffer = io.BytesIO()
    encoded = np.frombuffer(json.dumps(head).encode(), np.uint8)
    np.savez_compressed(buffer, allow_pickle=False, head=encoded, **arrays)
    return buffer.getvalue()


def _skin(points_mm: np.ndarray, faces: np.ndarray, areas_mm2: np.ndarray) -> SkinData:
    normals = corner_normals(points_mm, faces)
    return SkinData(points_mm=points_mm, faces=faces, normals=normals, areas_mm2=areas_mm2)


def _unusable(path: Path, why: str) -> StoreError:
    return StoreError(
        f"the held-out set {path} cannot be used: {why}",
        hint="make it again with workbench evaluate DATA --pack FILE",
        at=str(path),
    )
