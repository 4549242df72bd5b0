"""Moulds: closed single parts that neither overlap nor leave the cast another shape."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from geometry.housing.actuation import make_rods
from geometry.housing.housing import make_housing
from geometry.housing.supplies import ADHESIVE, bolt_length_mm, bolts, rim_mm2
from geometry.mould.cast import make_cast
from geometry.mould.demoulding import opening
from geometry.mould.mould_fit import measure_fit
from geometry.mould.moulds import make_mould
from geometry.objects.indenters import load_stl
from geometry.surface.surface import is_watertight, mesh_volume, pieces
from geometry.workshop.export import package_files, step_body, stl_bytes
from geometry.workshop.recipe import WantedMaterial, make_recipe
from geometry.workshop.step import write_step
from workbench.core.base.errors import DesignError, GeometryError, StoreError
from workbench.core.design.camera import Camera
from workbench.core.design.design import Elastomer, Layers, MouldOptions
from workbench.core.design.lighting import LedRing
from workbench.core.design.making import Casting, Housing, Printer
from workbench.core.result.fabrication import HousingSet, MouldSet, PartGroup, Recipe, SheetHead
from workbench.core.result.results import Solid


@pytest.fixture(scope="module")
def moulds(finger: Solid) -> MouldSet:
    """The mould of the default finger."""
    return make_mould(finger, MouldOptions())


@pytest.fixture(scope="module")
def housing(finger: Solid) -> HousingSet:
    """The rigid parts of the default finger."""
    return make_housing(finger, Housing(), ring=LedRing(), camera=Camera(), printer=Printer())


@pytest.fixture(scope="module")
def recipe(finger: Solid, moulds: MouldSet, housing: HousingSet) -> Recipe:
    """Its casting recipe."""
    return make_recipe(
        finger,
        moulds,
        housing,
        ring=LedRing(),
        casting=Casting(),
        wanted=WantedMaterial(
            young_MPa=Elastomer().young_MPa,
            density_g_cm3=Elastomer().density_g_cm3,
            backing_MPa=Elastomer().backing_MPa,
        ),
    )


def test_parts_are_single_closed_bodies_after_an_stl_file(
    moulds: MouldSet, housing: HousingSet, tmp_path: Path
) -> None:
    """One piece each, closed, volume kept in float32."""
    assert [part.name for part in moulds.parts] == ["half_a", "half_b", "core"]
    for part in (*moulds.parts, *housing.parts):
        path = tmp_path / f"{part.name}.stl"
        path.write_bytes(stl_bytes(part.points_mm, part.faces))
        mesh = load_stl(path)
        assert part.watertight
        assert is_watertight(mesh.faces)
        assert pieces(mesh.faces).max() == 0
        # The stated volume is the CAD kernel's; chords of 0.02 mm cost up to 0.3 %, and the
        # support's of 0.05 mm up to 0.5 %.
        assert mesh_volume(mesh.points_mm, mesh.faces) == pytest.approx(part.volume_mm3, rel=5e-3)


def test_cavity_is_the_membrane_enlarged_by_the_shrinkage(moulds: MouldSet, finger: Solid) -> None:
    """V / (1 - 0.002)^3 of the membrane's triangles; nothing overlaps."""
    membrane = mesh_volume(finger.membrane.points_mm, finger.membrane.faces)
    assert moulds.cast_volume_mm3 == pytest.approx(membrane / 0.998**3, rel=1e-6)
    assert moulds.overlap_mm3 <= 1e-6


def test_corners_that_float32_cannot_tell_apart_are_left_out_of_stl() -> None:
    """A cube with one corner split by 1e-9 mm: 12 triangles of 14; the file is closed."""
    import io

    import trimesh

    cube = trimesh.creation.box(extents=(2.0, 2.0, 2.0))
    points = np.vstack([cube.vertices, cube.vertices[cube.edges[0, 0]] + [1e-9, 0.0, 0.0]])
    # The new corner takes the place of the old one on one side of an edge from it.
    a, b = (int(i) for i in cube.edges[0])
    new, faces = len(points) - 1, np.array(cube.faces)
    faces[0][faces[0] == a] = new
    third = int(next(i for i in cube.faces[0] if i not in (a, b)))
    slivers = [[new, a, b], [a, new, third]]
    text = stl_bytes(points, np.vstack([faces, slivers]))
    assert int.from_bytes(text[80:84], "little") == 12
    assert trimesh.load_mesh(io.BytesIO(text), file_type="stl").is_watertight


def test_a_part_that_reaches_into_the_cast_is_refused(finger: Solid, moulds: MouldSet) -> None:
    """The core 0.01 mm aside takes 0.01 mm times its side view from the wall: 8 mm3; 1e-5 mm aside,
    8e-3 mm3, is rounding on some 8000 mm2 that touch."""
    import dataclasses

    cast = make_cast(finger, MouldOptions())
    core = next(part for part in moulds.parts if part.name == "core")
    aside = dataclasses.replace(core, points_mm=np.add(core.points_mm, (0.01, 0.0, 0.0)))
    with pytest.raises(GeometryError, match=r"mould parts overlap by \d+\.?\d* mm3") as caught:
        measure_fit([*moulds.parts[:2], aside], cast, [])
    found_mm3 = float(caught.value.message.split(" by ")[1].split(" mm3")[0])
    hair = dataclasses.replace(core, points_mm=np.add(core.points_mm, (1e-5, 0.0, 0.0)))
    overlap_mm3 = measure_fit([*moulds.parts[:2], hair], cast, []).overlap_mm3
    assert overlap_mm3 == pytest.approx(found_mm3 / 1000.0, rel=0.1)
    inner = cast.core
    assert inner is not None
    width_mm, _, height_mm = np.ptp(inner.points_mm, axis=0)
    # A cylinder of that width with half a sphere on it, seen from the side.
    side_mm2 = width_mm * (height_mm - width_mm / 2) + np.pi * width_mm**2 / 8
    assert found_mm3 == pytest.approx(0.01 * side_mm2, rel=0.02)


def test_finger_has_no_undercut_and_its_walls_are_good(moulds: MouldSet) -> None:
    """Thinnest wall 17 - 12.5 - 2 - 0.15 = 2.35 mm beside a lug; all checks are good."""
    assert moulds.thinnest_wall_mm == pytest.approx(2.35, abs=0.01)
    assert {check.severity for check in moulds.checks} == {"good"}


def test_the_recipe_can_be_followed_with_the_files(
    moulds: MouldSet, housing: HousingSet, recipe: Recipe
) -> None:
    """`recipe.json` names every part of the mould once; moved by its rows, no two parts meet."""
    import io
    import json

    import manifold3d
    import trimesh

    head = SheetHead(name="one", family="finger", shrink_percent=0.2, draft_deg=0.0)
    files = package_files(moulds, housing, recipe, head).files
    rows = json.loads(files["recipe.json"].tobytes())
    assert [(row["step"], row["part"]) for row in rows] == [
        (1, "half_a"),
        (2, "half_b"),
        (3, "core"),
    ]
    solids = {}
    for row in rows:
        data = io.BytesIO(files[f"moulds/{row['part']}.stl"].tobytes())
        mesh: Any = trimesh.load(data, file_type="stl")
        solids[row["part"]] = manifold3d.Manifold(
            manifold3d.Mesh(mesh.vertices.astype(np.float32), mesh.faces.astype(np.uint32))
        )
    for row in rows:
        name, way = row["part"], np.array(row["direction"])
        assert np.linalg.norm(way) == pytest.approx(1.0)
        for gone_mm in np.arange(1.0, row["distance_mm"] + 1.0):
            moved = solids[name].translate(gone_mm * way)
            others = [solid for other, solid in solids.items() if other != name]
            assert max((moved ^ other).volume() for other in others) < 0.01
        solids[name] = moved
    names = [row["part"] for row in rows]
    assert sorted(names) == sorted(part.name for part in moulds.parts)
    assert any("Pull half_a 42 mm along +X." in step for step in recipe.steps)
    assert "<td>half_a</td><td>1.000, 0.000, 0.000</td><td>42.0 mm</td>" in (
        files["build_sheet.html"].tobytes().decode()
    )
    # From the core's flange, 15 + 6 + 3 mm and the shrinkage wide, to the deepest key's end at -3.
    assert rows[0]["distance_mm"] == pytest.approx(
        30.0 / 0.998 / 2 + 6.0 + 3.0 + 3.0 + 15.0, abs=0.1
    )


def test_another_parting_is_tried_where_parts_jam(
    finger: Solid, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Two parts that are said to be in each other's way are given up for three that are not."""
    import dataclasses

    from geometry.mould import moulds as making

    def jammed(parts: Any, cast: Any, parting: Any, core_pull: Any) -> Any:
        found = opening(parts, cast, parting, core_pull)
        if parting.count == 3:
            return found
        return (dataclasses.replace(found[0], overlap_mm3=276.0), *found[1:])

    monkeypatch.setattr(making, "opening", jammed)
    made = make_mould(finger, MouldOptions())
    assert [part.name for part in made.parts][:3] == ["part_a", "part_b", "part_c"]
    assert all(motion.free for motion in made.motions)
    stuck = make_mould(finger, MouldOptions(outer_parts=2))
    (check,) = [c for c in stuck.checks if c.name == "demoulding" and c.severity == "bad"]
    assert (check.part, check.value) == ("half_a", 276.0)
    assert "276 mm3" in check.message


def test_gate_and_vents_open_into_the_wall(moulds: MouldSet) -> None:
    """Four holes on the circle of radius 14 / 0.998 mm: genus 4 by the Euler characteristic."""
    core = next(part for part in moulds.parts if part.name == "core")
    pairs = np.stack([core.faces, np.roll(core.faces, 1, axis=1)], axis=-1).reshape(-1, 2)
    edges = np.unique(np.sort(pairs, axis=1), axis=0)
    assert len(core.points_mm) - len(edges) + len(core.faces) == 2 - 2 * 4
    top = core.points_mm[np.abs(core.points_mm[:, 2]) < 1e-6]
    off = np.hypot(top[:, 0], top[:, 1]) - 14.0 / 0.998
    turn = np.degrees(np.arctan2(*top[np.abs(off) < 0.92, 1::-1].T))
    assert np.unique(np.round(turn / 30.0) * 30.0 % 360.0).tolist() == [0.0, 90.0, 180.0, 270.0]


@pytest.mark.parametrize("count", [3, 4])
def test_more_parts_close_around_the_same_cavity(finger: Solid, count: int) -> None:
    """Three or four sectors and the core; cavity and overlap as of two."""
    options = MouldOptions(outer_parts=count, shrink_percent=0.0)
    moulds = make_mould(finger, options)
    assert [part.name for part in moulds.parts] == [
        *(f"part_{letter}" for letter in "abcd"[:count]),
        "core",
    ]
    membrane = mesh_volume(finger.membrane.points_mm, finger.membrane.faces)
    assert moulds.cast_volume_mm3 == pytest.approx(membrane, rel=1e-6)
    assert all(part.watertight for part in moulds.parts)


def test_draft_tapers_the_core_by_its_angle(finger: Solid) -> None:
    """2 degrees on the straight part of the core; more silicone than without."""
    moulds = make_mould(finger, MouldOptions(draft_deg=2.0, shrink_percent=0.0))
    draft = next(c for c in moulds.checks if c.name == "draft" and c.part == "core")
    assert draft.value == pytest.approx(2.0, abs=0.01)
    assert moulds.cast_volume_mm3 > finger.volume_mm3
    assert "flat facets" in moulds.notice


def test_gate_wider_than_the_flange_is_refused(build_finger: Callable[..., Solid]) -> None:
    """Radius 6 and wall 3 mm leave (6 / 0.998 + 3 + 3 - 2) * 2 = 20 mm across."""
    with pytest.raises(DesignError, match=r"gate diameter 30 mm is wider than the 20\.0") as caught:
        make_mould(
            build_finger(outer_radius_mm=6.0, cylinder_mm=5.0),
            MouldOptions(gate_diameter_mm=30.0, wall_mm=3.0),
        )
    assert caught.value.at == "mould.gate_diameter_mm"


def test_housing_parts_clear_each_other_and_the_skin(housing: HousingSet, finger: Solid) -> None:
    """No two of support, holder, mount, base and membrane share more than 1e-6 mm3."""
    from geometry.body.csg_mesh import closed, overlaps_mm3

    assert [part.name for part in housing.parts] == [
        "support",
        "led_ring_holder",
        "camera_mount",
        "housing_base",
    ]
    solids = {part.name: closed(part.name, part.points_mm, part.faces) for part in housing.parts}
    membrane = finger.membrane
    solids["membrane"] = closed("membrane", membrane.points_mm, membrane.faces)
    assert max(overlaps_mm3(solids).values()) <= 1e-6
    clear = {check.name: check.severity for check in housing.checks}
    assert clear["led_clearance"] == clear["camera_clearance"] == "good"


def test_leds_too_far_out_are_told(finger: Solid) -> None:
    """A ring of radius 12 mm meets the support, whose inside has radius 12: bad, with its place."""
    ring = LedRing(radius_mm=12.0)
    found = make_housing(finger, Housing(), ring=ring, camera=Camera(), printer=Printer())
    check = next(check for check in found.checks if check.name == "led_clearance")
    assert check.severity == "bad"
    assert check.value < 0.0
    assert np.hypot(*check.place_mm[:2]) == pytest.approx(12.0, abs=0.3)


def test_recipe_masses_by_hand(recipe: Recipe, moulds: MouldSet) -> None:
    """m = 1.2 V rho with rho 1 g/cm3, one sixteenth of it part A; 9 LEDs of three colours."""
    mass_g = 1.2 * moulds.cast_volume_mm3 / 1000.0
    assert recipe.part_a_g == pytest.approx(mass_g / 16.0)
    assert recipe.part_b_g == pytest.approx(mass_g * 15.0 / 16.0)
    assert [led.colour for led in recipe.leds][::3] == ["#ff0000", "#00ff00", "#0000ff"]
    x, y, z = recipe.leds[0].position_mm
    assert (x, y, z) == pytest.approx(
        (9.0 * np.cos(np.radians(50.0)), 9.0 * np.sin(np.radians(50.0)), 0.5), abs=1e-6
    )
    # Cylinder and hemisphere of radius 15: 2 pi 15 (27 + 15), less 0.3 % of chords.
    assert recipe.coating_mm2 == pytest.approx(2.0 * np.pi * 15.0 * 42.0, rel=3e-3)


def read_threemf(data: bytes) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Points (N, 3) [mm] and faces (M, 3) of every object of a 3MF file by name."""
    import io
    import zipfile
    from xml.etree import ElementTree

    text = zipfile.ZipFile(io.BytesIO(data)).read("3D/3dmodel.model")
    found = {}
    for item in ElementTree.fromstring(text).iterfind(".//{*}object"):
        points = [[float(v.attrib[axis]) for axis in "xyz"] for v in item.iterfind(".//{*}vertex")]
        faces = [
            [int(t.attrib[f"v{k}"]) for k in (1, 2, 3)] for t in item.iterfind(".//{*}triangle")
        ]
        found[item.attrib["name"]] = (np.array(points), np.array(faces))
    return found


def test_files_are_complete_and_keep_volumes_and_names(
    moulds: MouldSet, housing: HousingSet, recipe: Recipe, tmp_path: Path
) -> None:
    """STL, STEP, 3MF of each part; assemblies read back with the parts' volumes."""
    from build123d import import_step

    head = SheetHead(name="one <finger>", family="finger", shrink_percent=0.2, draft_deg=0.0)
    files = package_files(moulds, housing, recipe, head).files
    parts = (*moulds.parts, *housing.parts)
    for part in parts:
        folder = "moulds" if part.group is PartGroup.MOULD else "parts"
        assert {f"{folder}/{part.name}.{end}" for end in ("stl", "step", "3mf")} <= set(files)
    path = tmp_path / "assembly.step"
    path.write_bytes(files["moulds/mould_assembly.step"].tobytes())
    assembly = import_step(str(path))
    assert [child.label for child in assembly.children] == ["half_a", "half_b", "core"]
    volumes = [part.volume_mm3 for part in moulds.parts]
    # STEP keeps 15 digits, OCCT integrates trimmed faces to about 1e-6.
    assert [solid.volume for solid in assembly.solids()] == pytest.approx(volumes, rel=1e-5)
    read = read_threemf(files["all_parts.3mf"].tobytes())
    assert list(read) == [part.name for part in parts]
    for part in parts:
        # 3MF is written in float32, good to 4e-6 mm.
        volume_mm3 = mesh_volume(part.points_mm, part.faces)
        assert mesh_volume(*read[part.name]) == pytest.approx(volume_mm3, rel=1e-5)
    sheet = files["build_sheet.html"].tobytes().decode()
    assert "http" not in sheet
    assert all(part.name in sheet for part in parts)
    assert files["bom.csv"].tobytes().count(b"\nLED,") == 9


def test_a_folder_that_is_not_there_is_named(moulds: MouldSet, tmp_path: Path) -> None:
    """StoreError, not a traceback of the kernel."""
    with pytest.raises(StoreError, match="cannot write"):
        write_step([step_body(moulds.parts[2])], "core", tmp_path / "gone" / "mould.step")


@pytest.mark.slow
@pytest.mark.parametrize("name", ["pad", "digitac", "trunk", "thumb", "tentacle", "paw"])
def test_every_family_has_a_mould(
    name: str, default_solid: Callable[[str], Solid], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The row of validation misses no limit."""
    from workbench.proof.validation.geometry import moulds

    monkeypatch.setattr(moulds, "default_solid", default_solid)
    (row,) = moulds.rows([name])
    assert row.ok, row.case


def test_what_to_buy_follows_from_the_parts(
    finger: Solid, moulds: MouldSet, housing: HousingSet, recipe: Recipe
) -> None:
    """Two bolts across 30 / 0.998 + 2 x 6 mm: 50 mm long; glue under a rim of pi (13^2 - 12^2)."""
    found = {item.name: item for item in recipe.supplies}
    count, clamped_mm = bolts(moulds)
    assert count == 2
    assert clamped_mm == pytest.approx(30.0 / 0.998 + 12.0, abs=0.05)
    # 42.1 + 2 x 0.5 + 2.4 + 0.5 = 46.
    assert found["M3 bolt, 50 mm"].amount == found["M3 nut"].amount == 2
    assert found["M3 washer"].amount == 4
    assert found["camera module"].details == "8.5 x 8.5 x 6 mm with its lens"
    support = next(part for part in housing.parts if part.name == "support")
    outside_mm = np.hypot(*support.points_mm[:, :2].T).max()
    rim = np.pi * (outside_mm**2 - (outside_mm - Layers().support_mm) ** 2)
    assert rim_mm2(finger.support) == pytest.approx(rim, rel=0.02)  # chords
    assert found[ADHESIVE].amount == pytest.approx(0.1 * rim / 1000.0, rel=0.02)
    assert any("Glue the support" in s and "which centres it" in s for s in recipe.steps)


def test_bolts_of_more_parts_and_of_wide_moulds() -> None:
    """16 mm are clamped by 20 mm, 96.1 mm by 100 mm, and more by no standard bolt."""
    assert bolt_length_mm(16.0) == 20.0
    assert bolt_length_mm(96.1) == 100.0
    assert bolt_length_mm(96.2) is None


def test_a_rod_says_what_it_is_for(default_solid: Callable[[str], Solid]) -> None:
    """`slider_0` of the trunk is the actuator rod for lobe 0."""
    rods = make_rods(default_solid("trunk"), Housing())
    assert [rod.title for rod in rods] == [f"actuator rod for lobe {n}" for n in (0, 1)]
