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


@pytest.mark.parametrize(("sides", "kept"), [(8, True), (12, False)])
def test_edges_that_turn_by_more_than_35_degrees_stay(sides: int, kept: bool) -> None:
    """Sides of a prism turn by 360 / sides: edges of 45 degrees keep the volume, 30 round off.

    The volume is sides r^2 sin(360 / sides) h / 2; triangles across an edge lie inside it.
    """
    angle = 2.0 * np.pi / sides
    around = 3.0 * np.exp(1j * angle * np.arange(sides))
    low, high, next_low = np.arange(sides), sides + np.arange(sides), np.roll(np.arange(sides), -1)
    points = np.zeros((2 * sides + 2, 3))
    points[:-2, 0], points[:-2, 1] = np.tile(around.real, 2), np.tile(around.imag, 2)
    points[sides : 2 * sides, 2] = points[-1, 2] = 4.0
    below, above = np.full(sides, 2 * sides), np.full(sides, 2 * sides + 1)
    faces = np.concatenate(
        [
            np.stack([low, next_low, high], axis=1),
            np.stack([next_low, sides + next_low, high], axis=1),
            np.stack([below, next_low, low], axis=1),
            np.stack([above, high, sides + next_low], axis=1),
        ]
    )
    exact_mm3 = sides * 3.0**2 * np.sin(angle) * 4.0 / 2.0
    assert mesh_volume(points, faces) == pytest.approx(exact_mm3)
    found_mm3 = mesh_volume(*meshlab.isotropic(points, faces, 0.7, None))
    if kept:
        assert found_mm3 == pytest.approx(exact_mm3, rel=1e-9)
    else:
        # A triangle across an edge has a sagitta of 0.7 / 4 tan 15 degrees = 0.05 mm of 3 at most.
        assert 0.97 * exact_mm3 < found_mm3 < 0.999 * exact_mm3


def test_tetrahedra_of_a_box_fill_it() -> None:
    """Cube of 64 mm3; its free faces enclose the same."""
    points, cells = tets._fill(remesh(box(), 1.5), 1.5)
    corner = points[cells]
    edges = corner[:, 1:] - corner[:, :1]
    # The envelope lets corners be cut by 3 % of an edge.
    assert np.linalg.det(edges).sum() / 6.0 == pytest.approx(64.0, rel=5e-3)
    faces = tets.boundary_faces(cells)
    assert mesh_volume(points, faces) == pytest.approx(np.linalg.det(edges).sum() / 6.0, rel=1e-9)
