"""Files for the workshop: parts as STL, STEP and 3MF, assemblies, build sheet, recipe, parts list.

A part without a B-rep body, or whose B-rep reads back as another body, gets a STEP file of flat
facets (`faceted`); a part that even that cannot hold gets none. Both are said. Assemblies are put
together from the parts' own files, and read back like them.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from geometry.body.csg_brep import translated
from geometry.body.solid import part_from_brep
from geometry.formats.threemf import threemf_bytes
from geometry.mould.fabricate import stl_points
from geometry.surface.surface import mesh_volume
from geometry.workshop.build_sheet import bom_csv, build_sheet_html
from geometry.workshop.faceted import faceted_step
from geometry.workshop.opening_words import recipe_json
from geometry.workshop.step import expect_assembly, expect_read_back, read_back, step_bytes
from geometry.workshop.step_assembly import assembly_step
from geometry.workshop.thinning import WITHIN_MM
from workbench.core.base.errors import GeometryError
from workbench.core.base.monitor import Monitor, silent
from workbench.core.result.fabrication import (
    FabricationPart,
    HousingSet,
    MouldSet,
    PartGroup,
    Recipe,
    SheetHead,
)
from workbench.core.result.results import Bundle

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
            said.append(
                f"{part.name} has no STEP file, and the assembly goes without it, so use its STL "
                f"or 3MF ({error.message})"
            )
            continue
        steps[part.name], files[f"{stem}.step"] = step, step.data
        said += [step.reason] if step.reason else []
    monitor(0.7, "writing the assemblies")
    for group, name in ASSEMBLIES.items():
        found = {p.name: steps[p.name] for p in parts if p.group is group and p.name in steps}
        data = {part: step.data for part, step in found.items()}
        try:
            if data:
                whole = assembly_step(name, data)
                expect_assembly(whole, [step.written_mm3 for step in found.values()], what=name)
                files[f"{FOLDERS[group]}/{name}.step"] = whole
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

    data: bytes
    volume_mm3: float
    reason: str
    """Why it has flat facets although the part has a B-rep, and how far they are off; else ""."""
    written_mm3: float
    """Volume for a reader that mends nothing; another one where seams of a B-rep are to mend."""


def step_file(part: FabricationPart) -> StepFile:
    """The part's STEP file; of flat facets where its B-rep cannot be written or read back.

    Raises:
        GeometryError: If the facets fail too.
    """
    volume_mm3, reason = mesh_volume(part.points_mm, part.faces), ""
    if part.brep.size:
        try:
            data = step_bytes([step_body(part)], part.name)
            found_mm3 = expect_read_back(data, volume_mm3, what=part.name)
            return StepFile(data, found_mm3, "", read_back(data, repaired=False).volume_mm3)
        except GeometryError as error:
            reason = f"{part.name}: its STEP file has flat facets ({error.message})"
    data, far_mm = faceted_step(part.points_mm, part.faces, name=part.name)
    if far_mm > WITHIN_MM:
        reason = reason or f"{part.name}: its STEP file has flat facets"
        reason += f", up to {far_mm:.2f} mm off its STL and 3MF, which hold all triangles"
    found_mm3 = expect_read_back(data, volume_mm3, what=part.name, repaired=False)
    return StepFile(data, found_mm3, reason, found_mm3)


def step_body(part: FabricationPart) -> Any:
    """The B-rep of a part as a named build123d body.

    Raises:
        GeometryError: If the kernel cannot read it.
    """
    body = translated(lambda: part_from_brep(part.brep), what=part.name)
    body.label = part.name
    return body
