"""A data set on disk: what is in the folder, and how learning reads it.

```
manifest.json      format, program, recipe with its key, mesh, counts
cases.jsonl        the cases in order, one per line
skin.npz           vertices, triangles, normals, areas and the inner skin's distance, once
cases/ID/000.npz   one sample, written whole or not at all
background.png     the skin at rest; background_markers.png with markers, their places in
                   background_markers_px.npy; of built sensors background-00.png ...
failed.jsonl       cases that failed, with their reasons
times.jsonl        seconds of each finished case
sequences.jsonl    frames that belong together, with and without slip, where asked for
card.md            the data card; preview.png shows samples
```

A sample is done when its file exists. `DataSet.open` refuses another format, a manifest or skin
that was changed, and each sample that is truncated, of another recipe, or not finite.
"""

from __future__ import annotations

import dataclasses
import json
import os
import zipfile
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from workbench.core.base.digest import digest
from workbench.core.base.errors import StoreError, shown
from workbench.core.result.results import Skin
from workbench.learning.dataset.cases import Case, Split, case_of_row
from workbench.learning.dataset.json_lines import read_rows
from workbench.learning.dataset.recipe import table_key
from workbench.learning.dataset.sample import Sample, from_bytes

FORMAT = 1
"""Raised whenever a reader of the old format would misread the new one."""
MANIFEST, CASES, SKIN = "manifest.json", "cases.jsonl", "skin.npz"
FAILED, TIMES = "failed.jsonl", "times.jsonl"
SAMPLES = "cases"
PLAIN, MARKED, MARKERS_PX = "background", "background_markers", "background_markers_px"


def background_name(part: str, look: int | None, suffix: str) -> str:
    """Name of a file of the skin at rest: `background.png`, of built sensor 3 `background-03.png`.

    Args:
        part: `PLAIN`, `MARKED` or `MARKERS_PX`.
        look: The built sensor; None: the design's own.
        suffix: `.png` or `.npy`.
    """
    return f"{part}{suffix}" if look is None else f"{part}-{look:02d}{suffix}"


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class SkinData:
    """The undeformed outer skin that all samples share."""

    points_mm: np.ndarray
    """Vertices [mm], shape (V, 3), float64."""
    faces: np.ndarray
    """Triangles, shape (F, 3), int32."""
    normals: np.ndarray
    """Outward unit normals of the vertices, shape (V, 3), float64."""
    areas_mm2: np.ndarray
    """Area of the skin that belongs to each vertex [mm2], shape (V,)."""


def skin_data(skin: Skin) -> SkinData:
    """What a data set keeps of a skin; each triangle gives a third of its area to a corner."""
    from geometry.surface.surface import vertex_areas_mm2

    return SkinData(
        points_mm=skin.points_mm,
        faces=skin.faces,
        normals=skin.normals,
        areas_mm2=vertex_areas_mm2(skin.points_mm, skin.faces),
    )


def mesh_key(skin: SkinData) -> str:
    """Digest of vertices and triangles."""
    return digest([np.asarray(skin.points_mm), np.asarray(skin.faces)])


def sample_name(frame: int) -> str:
    """Name of the file of a frame."""
    return f"{frame:03d}.npz"


class DataSet:
    """A data set that exists."""

    def __init__(
        self, folder: Path, manifest: Mapping[str, Any], skin: SkinData, cases: Sequence[Case]
    ) -> None:
        self.folder = folder
        self.manifest = manifest
        self.skin = skin
        self.all_cases = tuple(cases)
        """In the order in which they are made."""

    @classmethod
    def open(cls, folder: Path | str) -> DataSet:
        """Open a data set and check that it is whole and of this format.

        Raises:
            StoreError: If there is none, it is of another format, or was changed.
        """
        folder = Path(folder)
        manifest = _manifest(folder)
        skin = _skin(folder)
        if mesh_key(skin) != manifest.get("mesh"):
            raise _changed(folder, f"{SKIN} is not the skin that the manifest names")
        return cls(folder, manifest, skin, _cases(folder))

    @property
    def key(self) -> str:
        """Key of its recipe."""
        return self.manifest["key"]

    def background(self, case: Case) -> bytes:
        """The skin at rest as the sensor of a case sees it, a PNG file; empty without images."""
        path = self.folder / background_name(PLAIN, case.drawn.look, ".png")
        return path.read_bytes() if path.exists() else b""

    def markers_at_rest_px(self, case: Case) -> np.ndarray:
        """u, v of the markers at rest for the sensor of a case [px], (M, 2); (0, 2) if none."""
        look = case.drawn.look
        path = self.folder / background_name(MARKERS_PX, look, ".npy")
        return np.load(path) if path.exists() else np.zeros((0, 2), np.float32)

    def cases(self, split: Split | str | None = None) -> list[Case]:
        """The cases of one split, or all, in the order in which they are made."""
        return [case for case in self.all_cases if split in (None, case.split)]

    def path(self, case: Case, frame: int) -> Path:
        """File of a sample, whether it exists or not."""
        return self.folder / SAMPLES / case.id / sample_name(frame)

    def frames(self, case: Case) -> list[int]:
        """Frames of a case that are done, in order."""
        try:
            there = set(os.listdir(self.folder / SAMPLES / case.id))
        except (FileNotFoundError, NotADirectoryError):
            return []
        return [frame for frame in range(case.frames) if sample_name(frame) in there]

    def sample(self, case: Case, frame: int) -> Sample:
        """Read a sample.

        Raises:
            StoreError: If it is missing, damaged, of another recipe or not finite.
        """
        path = self.path(case, frame)
        try:
            sample = from_bytes(path.read_bytes(), len(self.skin.points_mm))
            if sample.recipe != self.key:
                raise ValueError("it was made by another recipe")
            if (sample.case, sample.frame) != (case.id, frame):
                raise ValueError(f"it is frame {sample.frame} of {sample.case}")
        except (OSError, ValueError) as error:
            raise StoreError(
                f"the sample {path} cannot be used: {error}",
                hint=f"run workbench dataset repair {self.folder}, then make it again",
                at=str(path),
            ) from error
        return sample

    def samples(
        self, split: Split | str | None = None, *, repeats: bool = False
    ) -> Iterator[tuple[Case, Sample]]:
        """All samples that are done, case by case.

        Args:
            split: Of one split only.
            repeats: Also states that an earlier case holds: the approach of the same pair.

        Raises:
            StoreError: As `sample`.
        """
        for case in self.cases(split):
            for frame in self.frames(case):
                if repeats or frame >= case.first_new:
                    yield case, self.sample(case, frame)

    def failed(self) -> dict[str, dict[str, Any]]:
        """Reason of each failed case, by its id."""
        return {row["id"]: row for row in read_rows(self.folder / FAILED)}

    def counts(self) -> dict[str, Any]:
        """What is asked for, done and failed, in all and by split."""
        cases, failed = self.all_cases, self.failed()
        done = [self.frames(case) for case in cases]
        by_split: Counter[Split] = Counter()
        for case, frames in zip(cases, done, strict=True):
            by_split[case.split] += len(frames)
        return {
            "cases": len(cases),
            "cases_done": sum(len(f) == c.frames for c, f in zip(cases, done, strict=True)),
            "cases_failed": sum(case.id in failed for case in cases),
            "samples": sum(case.frames for case in cases),
            "samples_done": sum(map(len, done)),
            "samples_distinct": sum(
                frame >= case.first_new
                for case, frames in zip(cases, done, strict=True)
                for frame in frames
            ),
            "samples_by_split": {split.value: by_split[split] for split in Split},
        }


def _manifest(folder: Path) -> dict[str, Any]:
    try:
        manifest = json.loads((folder / MANIFEST).read_bytes())
        found = manifest["format"]
    except OSError as error:
        raise StoreError(
            f"there is no data set in {folder}: {error.strerror or error}",
            hint="make one with workbench dataset make",
            at=str(folder),
        ) from error
    except (ValueError, KeyError, TypeError) as error:
        raise _changed(folder, f"{MANIFEST} cannot be read: {error!r}") from error
    if found != FORMAT:
        raise StoreError(
            f"the data set {folder} has format {shown(found)}, made by program "
            f"{manifest.get('program', 'unknown')}; this one reads format {FORMAT}",
            hint="use the program that made it, or make it anew in another folder",
            at=str(folder),
        )
    try:
        key = table_key(manifest["recipe"])
    except (KeyError, TypeError, ValueError) as error:
        raise _changed(folder, f"{MANIFEST} lacks {error}") from error
    if key != manifest.get("key"):
        raise _changed(folder, f"the recipe in {MANIFEST} is not the one it was begun with")
    return manifest


def _skin(folder: Path) -> SkinData:
    try:
        with np.load(folder / SKIN) as file:
            return SkinData(**{f.name: file[f.name] for f in dataclasses.fields(SkinData)})
    except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile) as error:
        raise _changed(folder, f"{SKIN} cannot be read: {error}") from error


def _cases(folder: Path) -> list[Case]:
    try:
        return [case_of_row(row) for row in read_rows(folder / CASES)]
    except (KeyError, TypeError, ValueError) as error:
        raise _changed(folder, f"{CASES} cannot be read: {error!r}") from error


def _changed(folder: Path, what: str) -> StoreError:
    return StoreError(
        f"the data set {folder} is damaged: {what}",
        hint="copy it again from where it came from, or make it anew in another folder",
        at=str(folder),
    )
