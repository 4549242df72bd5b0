"""Optional meshing tools that are missing say so, with a remedy."""

from __future__ import annotations

import sys

import numpy as np
import pytest

from geometry.intake.intake import read_body
from geometry.surface import meshlab
from geometry.surface.primitives import rounded_box
from geometry.surface.remesh import remesh
from geometry.surface.surface import face_areas, mesh_volume
from geometry.volume import tets
from geometry.workshop.export import stl_bytes
from workbench.core.base.errors import MeshingError
from workbench.core.design.imported import ImportedBody, LengthUnit, body_file
from workbench.core.result.results import Label, LabelledSurface


def box() -> LabelledSurface:
    """A 4 mm cube on z = 0: base at the bottom, inner at the top, outer around."""
    points, faces = rounded_box(2.0, 0.0)
    points = points + np.array([0.0, 0.0, 2.0])
    centre = points[faces].mean(axis=1)
    labels = np.full(len(faces), Label.OUTER, dtype=np.uint8)
    labels[np.abs(points[faces, 2]).max(axis=1) < 1e-9] = Label.BASE
    labels[centre[:, 2] > 3.999] = Label.INNER
    return LabelledSurface(points_mm=points, faces=faces, labels=labels)


@pytest.mark.parametrize(("module", "tool"), [(meshlab, "pymeshlab"), (tets, "pytetwild")])
def test_missing_tools_are_named(
    module: object, tool: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The message names the package, the hint the command that installs it."""
    monkeypatch.setitem(sys.modules, tool, None)
    load = module._meshlab if tool == "pymeshlab" else module._tetwild  # pyright: ignore
    with pytest.raises(MeshingError, match=tool) as caught:
        load()
    assert f"pip install {tool}" in caught.value.hint


def test_a_file_that_cannot_be_read_without_a_tool_is_named(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The message belongs under the file's button, not under the mesh size."""
    monkeypatch.setitem(sys.modules, "pymeshlab", None)
    cube = box()
    file = body_file("cube.stl", stl_bytes(cube.points_mm, cube.faces))
    with pytest.raises(MeshingError, match="pymeshlab") as caught:
        read_body(ImportedBody(outer=file, unit=LengthUnit.MM))
    assert caught.value.at == "body.outer"


def test_remeshed_box_keeps_its_corners_regions_and_sense() -> None:
    """Cube of 64 mm3: plane faces and sharp edges stay exact, each region 16 mm2 or 4 x 16."""
    even = remesh(box(), 0.5)
    assert mesh_volume(even.points_mm, even.faces) == pytest.approx(64.0, rel=1e-5)
    areas = face_areas(even.points_mm, even.faces)
    for label, area_mm2 in ((Label.BASE, 16.0), (Label.INNER, 16.0), (Label.OUTER, 64.0)):
        assert areas[even.has(label)].sum() == pytest.approx(area_mm2, rel=1e-5)
    corners = even.points_mm[even.faces]
    edges = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2)
    assert 0.35 < np.percentile(edges, 5) < np.percentile(edges, 95) < 0.7


def test_tetrahedra_of_a_box_fill_it() -> None:
    """Cube of 64 mm3; its free faces enclose the same."""
    points, cells = tets._fill(remesh(box(), 1.5), 1.5)
    corner = points[cells]
    edges = corner[:, 1:] - corner[:, :1]
    # The envelope lets corners be cut by 3 % of an edge.
    assert np.linalg.det(edges).sum() / 6.0 == pytest.approx(64.0, rel=5e-3)
    faces = tets.boundary_faces(cells)
    assert mesh_volume(points, faces) == pytest.approx(np.linalg.det(edges).sum() / 6.0, rel=1e-9)
