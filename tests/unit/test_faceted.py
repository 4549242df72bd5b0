"""STEP files of facets hold the mesh's body, are few, and go together into assemblies."""

# OCP has no type stubs.
# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh

from geometry.body.csg_mesh import arrays
from geometry.surface.isosurface import distance_mm
from geometry.surface.surface import mesh_volume
from geometry.workshop import thinning
from geometry.workshop.export import step_file
from geometry.workshop.faceted import faceted_step
from geometry.workshop.step_assembly import assembly_step
from geometry.workshop.thinning import FARTHEST_MM, USUAL_FACETS, thinned
from workbench.core.base.errors import GeometryError
from workbench.core.result.fabrication import FabricationPart, PartGroup


def ball(subdivisions: int, waves_mm: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    """A ball of 15 mm, on which waves may run around X."""
    made = trimesh.creation.icosphere(subdivisions, 15.0)
    points = np.array(made.vertices)
    points *= 1.0 + waves_mm / 15.0 * np.sin(points[:, [0]])
    return points, np.asarray(made.faces)


def pinned(*, outward: bool) -> tuple[np.ndarray, np.ndarray]:
    """A block of 60 x 40 x 30 mm with 228 pins, or blind holes, of 0.6 x 0.9 mm in its top."""
    import manifold3d

    block = manifold3d.Manifold.cube((60.0, 40.0, 30.0), center=True)
    pin = manifold3d.Manifold.cylinder(1.8, 0.3, circular_segments=16, center=True)
    places = [(x, y, 15.0) for x in np.linspace(-27, 27, 19) for y in np.linspace(-17, 17, 12)]
    pins = manifold3d.Manifold.batch_boolean(
        [pin.translate(place) for place in places], manifold3d.OpType.Add
    )
    return arrays(block + pins if outward else block - pins)


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
    assert data.count(b"POLY_LOOP") <= USUAL_FACETS
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


@pytest.mark.parametrize("outward", [True, False])
def test_pins_and_blind_holes_of_a_block_are_not_thinned_away(outward: bool) -> None:
    """228 of 0.6 x 0.9 mm: .08 % of the volume, and another body without them."""
    points, faces = pinned(outward=outward)
    fewer, facets, far_mm = thinned(points, faces, what="block")
    assert far_mm <= FARTHEST_MM
    assert distance_mm(fewer, facets, points).max() <= far_mm
    pins_mm3 = mesh_volume(points, faces) - 72000.0
    assert mesh_volume(fewer, facets) - 72000.0 == pytest.approx(pins_mm3, rel=0.1)


def test_a_body_that_no_facets_hold_is_refused_with_the_remedy(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Where 2,500 facets were the most: the pins would be gone, so nothing is written."""
    monkeypatch.setattr(thinning, "MOST_FACETS", USUAL_FACETS)
    with pytest.raises(GeometryError, match=r"no STEP file .* is within 0\.2 mm") as caught:
        faceted_step(*pinned(outward=True), name="block")
    assert "STL or 3MF" in caught.value.hint


@pytest.mark.parametrize("waves_mm", [0.0, 0.8])
def test_a_distance_that_counts_is_told(waves_mm: float) -> None:
    """Of a ball nothing is said; with waves the facets are 0.12 mm off, and the part's reason."""
    points, faces = ball(6, waves_mm)
    part = FabricationPart(
        name="ball",
        group=PartGroup.SENSOR,
        points_mm=points,
        faces=faces.astype(np.int32),
        brep=np.zeros(0, dtype=np.uint8),
        explode=(0.0, 0.0, 0.0),
        volume_mm3=mesh_volume(points, faces),
        watertight=True,
    )
    found = re.search(r"flat facets, up to (\d\.\d\d) mm off its STL", step_file(part).reason)
    assert bool(found) == bool(waves_mm)
    if found:
        assert float(found[1]) == pytest.approx(thinned(points, faces, what="ball")[2], abs=0.005)


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
