"""Files for the workshop: every part as STL, STEP and 3MF, assemblies, build sheet and parts list.

A part without a B-rep body gets a STEP file of flat facets (`faceted`); a part that even that
cannot hold gets none, and the build sheet says so.
"""

from __future__ import annotations

import dataclasses
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from geometry.build_sheet import bom_csv, build_sheet_html
from geometry.csg_brep import translated
from geometry.fabricate import NO_BREP, stl_points
from geometry.faceted import faceted
from geometry.solid import part_from_brep
from geometry.threemf import threemf_bytes
from workbench.core.errors import GeometryError, StoreError
from workbench.core.fabrication import (
    FabricationPart,
    HousingSet,
    MouldSet,
    PartGroup,
    Recipe,
    SheetHead,
)
from workbench.core.monitor import Monitor, silent

ASSEMBLIES = {PartGroup.MOULD: "mould_assembly", PartGroup.SENSOR: "sensor_assembly"}
ALL_PARTS = "all_parts.3mf"
FOLDERS = {PartGroup.MOULD: "moulds", PartGroup.SENSOR: "parts"}
"""Folder of each group's files within the results."""
HEADER = b"binary STL in millimetres"


def stl_bytes(points_mm: np.ndarray, faces: np.ndarray) -> bytes:
    """A binary STL file [mm]: 80 bytes of header, the count, 50 bytes a triangle.

    Triangles with corners that the file cannot tell apart are left out: to a reader that welds
    equal corners their sides would be edges of four faces.
    """
    corners = stl_points(points_mm)[faces].astype(np.float64)
    corners = corners[np.any(corners != np.roll(corners, 1, axis=1), axis=2).all(axis=1)]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300)
    record = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("spare", "<u2")])
    rows = np.zeros(len(corners), dtype=record)
    rows["normal"], rows["corners"] = normal, corners
    return HEADER.ljust(80, b"\0") + np.array(len(corners), dtype="<u4").tobytes() + rows.tobytes()


def package_files(
    moulds: MouldSet,
    housing: HousingSet,
    recipe: Recipe,
    head: SheetHead,
    monitor: Monitor = silent,
) -> dict[str, np.ndarray]:
    """Every file of the workshop, by its path within the results, shape (bytes,), uint8."""
    parts = (*moulds.parts, *housing.parts)
    files: dict[str, bytes] = {}
    bodies: dict[str, Any] = {}
    missing: list[str] = []
    for number, part in enumerate(parts):
        monitor(0.7 * number / len(parts), f"writing {part.name}")
        stem = f"{FOLDERS[part.group]}/{part.name}"
        files[f"{stem}.stl"] = stl_bytes(part.points_mm, part.faces)
        files[f"{stem}.3mf"] = threemf_bytes([part])
        try:
            bodies[part.name], files[f"{stem}.step"] = step_file(part)
        except GeometryError as error:
            missing.append(error.message)
    monitor(0.7, "writing the assemblies")
    for group, name in ASSEMBLIES.items():
        found = [bodies[p.name] for p in parts if p.group is group and p.name in bodies]
        try:
            if found:
                files[f"{FOLDERS[group]}/{name}.step"] = step_bytes(found, name)
        except GeometryError as error:
            missing.append(error.message)
    files[ALL_PARTS] = threemf_bytes(parts)
    sheet = build_sheet_html(moulds, housing, recipe, missing, head=head)
    files["build_sheet.html"] = sheet.encode()
    files["bom.csv"] = bom_csv(recipe).encode()
    return {name: np.frombuffer(data, dtype=np.uint8).copy() for name, data in files.items()}


def step_file(part: FabricationPart) -> tuple[Any, bytes]:
    """The part's body and its STEP file; of flat facets where the kernel refuses the B-rep.

    Raises:
        GeometryError: If it refuses the facets too.
    """
    try:
        body = step_body(part)
        return body, step_bytes([body], part.name)
    except GeometryError:
        if not part.brep.size:
            raise
    return step_file(dataclasses.replace(part, brep=NO_BREP))


def step_body(part: FabricationPart) -> Any:
    """The part as a named build123d body: its B-rep, or flat facets.

    Raises:
        GeometryError: If it has neither.
    """
    if part.brep.size:
        body = translated(lambda: part_from_brep(part.brep), what=part.name)
    else:
        body = translated(
            lambda: faceted(part.points_mm, part.faces, what=part.name), what=part.name
        )
    body.label = part.name
    return body


def step_bytes(bodies: Sequence[Any], name: str) -> bytes:
    """A STEP file: of one body as it is, of several as an assembly of named parts."""
    # OCCT writes STEP to named files only.
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "part.step"
        write_step(bodies, name, path)
        return path.read_bytes()


def write_step(bodies: Sequence[Any], name: str, path: Path) -> None:
    """Write a STEP file.

    Raises:
        StoreError: If the file cannot be written.
        GeometryError: If the kernel cannot turn a body into STEP.
    """
    from build123d import Compound, export_step

    def written() -> bool:
        shape = bodies[0] if len(bodies) == 1 else Compound(label=name, children=list(bodies))
        try:
            return export_step(shape, str(path), timestamp="2000-01-01T00:00:00")
        except (OSError, RuntimeError) as error:
            raise _unwritten(path) from error

    if not translated(written, what=name):
        raise _unwritten(path)


def _unwritten(path: Path) -> StoreError:
    return StoreError(
        f"cannot write {path}", hint="check that the folder exists and has room", at="out"
    )
