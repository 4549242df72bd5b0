"""Files for the workshop: every part as STL, STEP and 3MF, assemblies, build sheet,
motions of the recipe and parts list.

A part without a B-rep body, or whose B-rep reads back as another body, gets a STEP file of flat
facets (`faceted`); a part that even that cannot hold gets none. Both are said.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from geometry.build_sheet import bom_csv, build_sheet_html
from geometry.csg_brep import translated
from geometry.fabricate import NO_BREP, stl_points
from geometry.faceted import faceted
from geometry.opening_words import recipe_json
from geometry.solid import part_from_brep
from geometry.step import expect_read_back, step_bytes
from geometry.surface import mesh_volume
from geometry.threemf import threemf_bytes
from workbench.core.errors import GeometryError
from workbench.core.fabrication import (
    FabricationPart,
    HousingSet,
    MouldSet,
    PartGroup,
    Recipe,
    SheetHead,
)
from workbench.core.monitor import Monitor, silent
from workbench.core.results import Bundle

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
) -> Bundle:
    """Every file of the workshop, by its path within the results."""
    parts = (*moulds.parts, *housing.parts)
    files: dict[str, bytes] = {}
    steps: dict[str, StepFile] = {}
    said: list[str] = []
    for number, part in enumerate(parts):
        monitor(0.7 * number / len(parts), f"writing {part.name}")
        stem = f"{FOLDERS[part.group]}/{part.name}"
        files[f"{stem}.stl"] = stl_bytes(part.points_mm, part.faces)
        files[f"{stem}.3mf"] = threemf_bytes([part])
        try:
            step = step_file(part)
        except GeometryError as error:
            said.append(error.message)
            continue
        steps[part.name], files[f"{stem}.step"] = step, step.data
        said += [step.reason] if step.reason else []
    monitor(0.7, "writing the assemblies")
    for group, name in ASSEMBLIES.items():
        found = [steps[p.name] for p in parts if p.group is group and p.name in steps]
        try:
            if found:
                files[f"{FOLDERS[group]}/{name}.step"] = assembly_bytes(found, name)
        except GeometryError as error:
            said.append(error.message)
    files[ALL_PARTS] = threemf_bytes(parts)
    sheet = build_sheet_html(moulds, housing, recipe, said, head=head)
    files["build_sheet.html"] = sheet.encode()
    files["bom.csv"] = bom_csv(recipe).encode()
    files["recipe.json"] = recipe_json(moulds.motions)
    return Bundle(
        files={name: np.frombuffer(data, dtype=np.uint8).copy() for name, data in files.items()},
        step_volumes_mm3={name: step.volume_mm3 for name, step in steps.items()},
        notice="; ".join(said),
    )


class StepFile(NamedTuple):
    """A part as STEP, and what a reader finds in it."""

    body: Any
    data: bytes
    volume_mm3: float
    reason: str
    """Why it has flat facets although the part has a B-rep; else ""."""


def step_file(part: FabricationPart) -> StepFile:
    """The part's STEP file; of flat facets where its B-rep cannot be written or read back.

    Raises:
        GeometryError: If the facets fail too.
    """
    volume_mm3 = mesh_volume(part.points_mm, part.faces)
    try:
        return _written(part, volume_mm3)
    except GeometryError as error:
        if not part.brep.size:
            raise
        facets = _written(dataclasses.replace(part, brep=NO_BREP), volume_mm3)
        reason = f"{part.name}: its STEP file has flat facets ({error.message})"
        return facets._replace(reason=reason)


def assembly_bytes(steps: Sequence[StepFile], name: str) -> bytes:
    """A STEP file of several parts, read back like those of one.

    Raises:
        GeometryError: If it reads back as something else.
    """
    data = step_bytes([step.body for step in steps], name)
    expect_read_back(data, [step.volume_mm3 for step in steps], what=name)
    return data


def _written(part: FabricationPart, volume_mm3: float) -> StepFile:
    body = step_body(part)
    data = step_bytes([body], part.name)
    found_mm3 = expect_read_back(data, [volume_mm3], what=part.name)
    return StepFile(body, data, found_mm3, "")


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
