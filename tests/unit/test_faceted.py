"""STEP files of facets hold the mesh's body, are few, and go together into assemblies."""

# OCP has no type stubs.
# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh

from geometry.faceted import faceted_step
from geometry.step_assembly import assembly_step
from geometry.surface import mesh_volume
from geometry.thinning import MOST_FACETS, thinned
from workbench.core.errors import GeometryError


def ball(subdivisions: int, waves_mm: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    """A ball of 15 mm, on which waves may run around X."""
    made = trimesh.creation.icosphere(subdivisions, 15.0)
    points = np.array(made.vertices)
    points *= 1.0 + waves_mm / 15.0 * np.sin(points[:, [0]])
    return points, np.asarray(made.faces)


def read(data: bytes, folder: Path) -> Any:
    from build123d import import_step

    path = folder / "part.step"
    path.write_bytes(data)
    return import_step(str(path))


@pytest.mark.parametrize(("subdivisions", "waves_mm"), [(2, 0.0), (5, 0.0), (6, 0.4)])
def test_facets_read_back_as_one_valid_solid(
    tmp_path: Path, subdivisions: int, waves_mm: float
) -> None:
    """320, 20,480 and 81,920 triangles: at most 2,500 facets, the mesh's volume to 0.3 %."""
    points, faces = ball(subdivisions, waves_mm)
    data, far_mm = faceted_step(points, faces, name="ball")
    body = read(data, tmp_path)
    assert body.label == "ball"
    assert len(body.solids()) == 1
    assert body.is_valid
    assert len(body.faces()) == min(len(faces), data.count(b"POLY_LOOP"))
    assert data.count(b"POLY_LOOP") <= MOST_FACETS
    assert body.volume == pytest.approx(mesh_volume(points, faces), rel=3e-3)
    assert far_mm < 0.2
    assert f"at most {far_mm:.3f} mm from the mesh".encode() in data


def test_a_flat_block_keeps_its_twelve_triangles(tmp_path: Path) -> None:
    """Nothing is thinned out of what is small: 10 x 20 x 30 holds 6,000 mm3 to the last digit."""
    box = trimesh.creation.box((10.0, 20.0, 30.0))
    data, far_mm = faceted_step(np.asarray(box.vertices), np.asarray(box.faces), name="box")
    assert far_mm == 0.0
    assert read(data, tmp_path).volume == pytest.approx(6000.0, rel=1e-9)


def test_the_stated_distance_is_that_of_the_facets() -> None:
    """Against the exact ball: the chords' own 0.005 mm more, no less than half of it."""
    points, faces = ball(5)
    fewer, facets, far_mm = thinned(points, faces, what="ball")
    middle = np.linalg.norm(fewer[facets].mean(axis=1), axis=1)
    deepest = 15.0 - float(middle.min())
    assert 0.5 * far_mm < deepest < far_mm + 0.01


def test_an_open_mesh_is_refused() -> None:
    """A STEP solid needs a closed shell."""
    points, faces = ball(2)
    with pytest.raises(GeometryError, match="not a closed body"):
        faceted_step(points, faces[1:], name="ball")


def test_an_assembly_keeps_names_places_and_numbers(tmp_path: Path) -> None:
    """A B-rep whose name holds a hash, and a ball of facets: both where they were."""
    from build123d import Box, Pos, export_step

    box = Pos(40, 0, 0) * Box(10, 20, 30)
    box.label = "box #10"
    export_step(box, str(tmp_path / "box.step"))
    points, faces = ball(2)
    parts = {
        "box": (tmp_path / "box.step").read_bytes(),
        "ball": faceted_step(points, faces, name="ball")[0],
    }
    both = read(assembly_step("pair", parts), tmp_path)
    assert both.label == "pair"
    assert len(both.children) == 2
    first, second = both.children
    assert first.volume == pytest.approx(6000.0)
    assert first.bounding_box().min.X == pytest.approx(35.0)
    assert second.volume == pytest.approx(mesh_volume(points, faces), rel=1e-6)


def test_assemblies_nest_and_a_file_without_a_product_is_refused(tmp_path: Path) -> None:
    """Two balls as one component of another assembly; text that is no STEP has no product."""
    points, faces = ball(1)
    part = faceted_step(points, faces, name="ball")[0]
    nested = assembly_step("two", {"a": part, "b": part})
    whole = read(assembly_step("all", {"two": nested, "one": part}), tmp_path)
    assert len(whole.solids()) == 3
    with pytest.raises(GeometryError, match="file of nothing holds no product"):
        assembly_step("all", {"nothing": b"DATA;\nENDSEC;\n"})
