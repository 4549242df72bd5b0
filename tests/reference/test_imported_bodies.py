"""Bodies from files become membranes of the right thickness, with their faces labelled."""

from __future__ import annotations

import dataclasses
import math
from typing import Any

import numpy as np
import pytest

from designs.imported import ImportedShape
from geometry.body.csg_mesh import closed
from geometry.intake.imported import build_imported
from geometry.intake.intake import read_body
from geometry.intake.shell import outer_and_inner
from geometry.surface.isosurface import distance_mm, isosurface
from geometry.surface.offset import inset_surface, inside
from geometry.surface.surface import face_areas, is_watertight, mesh_volume
from geometry.workshop.export import stl_bytes
from tests.foreign_bodies import cup
from workbench.core.base.errors import DesignError
from workbench.core.design.design import Layers, SensorDesign
from workbench.core.design.imported import ImportedBody, LengthUnit, Pick, ReadBody, body_file
from workbench.core.result.results import Label, Solid, region_masks
from workbench.planning.fitting import fitted
from workbench.project.aim import default_target_mm

SIDES = 96
RADIUS_MM, HEIGHT_MM = 12.0, 20.0


def drum(
    radius_mm: float = RADIUS_MM, height_mm: float = HEIGHT_MM
) -> tuple[np.ndarray, np.ndarray]:
    """A prism of 96 sides, which holds 7e-4 less than the cylinder around it, on z = 0."""
    import trimesh

    mesh = trimesh.creation.cylinder(radius_mm, height_mm, sections=SIDES)
    return np.add(mesh.vertices, [0.0, 0.0, height_mm / 2]), np.asarray(mesh.faces)


def body_of(points: np.ndarray, faces: np.ndarray, **more: Any) -> ReadBody:
    inner = body_file("inner.stl", stl_bytes(*more["inner"])) if more else None
    outer = body_file("outer.stl", stl_bytes(points, faces))
    return read_body(ImportedBody(outer=outer, inner=inner))


@pytest.fixture(scope="module")
def read_drum() -> ReadBody:
    return body_of(*drum())


@pytest.fixture(scope="module")
def hollow_drum(read_drum: ReadBody) -> Solid:
    return build_imported(read_drum, ImportedShape(), Layers())


def areas(solid: Solid) -> dict[str, float]:
    surface = solid.membrane
    area = face_areas(surface.points_mm, surface.faces)
    masks = region_masks(surface.labels, surface.numbers)
    return {name: float(area[mask].sum()) for name, mask in masks.items()}


def test_an_even_wall_under_a_drum(hollow_drum: Solid) -> None:
    """V = pi (12^2 20 - 10^2 18) = 3393 mm3; base, outer and inner areas in closed form."""
    assert hollow_drum.volume_mm3 == pytest.approx(
        math.pi * (144.0 * 20.0 - 100.0 * 18.0), rel=3e-3
    )
    found = areas(hollow_drum)
    # 96 sides: 7e-4. Marching cubes cut the corner of the core's edge, 63 mm long, by half a step
    # of 0.4 mm on each face: 2 (1 - sqrt(1/2)) 0.2 mm 63 mm = 0.5 % of the area, or somewhat more.
    assert found["outer"] == pytest.approx(math.pi * (144.0 + 24.0 * 20.0), rel=2e-3)
    assert found["inner"] == pytest.approx(math.pi * (100.0 + 20.0 * 18.0), rel=1e-2)
    assert found["base"] == pytest.approx(math.pi * 44.0, rel=5e-3)
    for surface in (hollow_drum.membrane, hollow_drum.support, hollow_drum.base):
        assert is_watertight(surface.faces)
        assert mesh_volume(surface.points_mm, surface.faces) > 0.0


def test_the_support_follows_inside(hollow_drum: Solid) -> None:
    """V = pi (10^2 18 - 9^2 17) = 1329 mm3 for 1 mm of support."""
    support = hollow_drum.support
    exact = math.pi * (100.0 * 18.0 - 81.0 * 17.0)
    # A wall of 1 mm with both sides by marching cubes.
    assert mesh_volume(support.points_mm, support.faces) == pytest.approx(exact, rel=1e-2)


def test_an_inner_file_makes_the_wall() -> None:
    """A drum of 9 x 15 mm in one of 12 x 20: V = pi (144 20 - 81 15) = 5231 mm3."""
    solid = build_imported(body_of(*drum(), inner=drum(9.0, 15.0)), ImportedShape(), Layers())
    assert solid.volume_mm3 == pytest.approx(math.pi * (144.0 * 20.0 - 81.0 * 15.0), rel=2e-3)


def test_a_ball_is_cut_flat() -> None:
    """Ball of 15 mm cut 5 mm up: outer area 2 pi R (2 R - 5) = 2356 mm2, centred on the base."""
    import trimesh

    ball = trimesh.creation.icosphere(3, 15.0)
    body = body_of(np.add(ball.vertices, [7.0, -3.0, 2.0]), np.asarray(ball.faces))
    solid = build_imported(body, ImportedShape(cut_mm=5.0), Layers())
    # 1280 facets hold 4e-3 less.
    assert areas(solid)["outer"] == pytest.approx(2 * math.pi * 15.0 * 25.0, rel=6e-3)
    low, high = solid.membrane.points_mm.min(axis=0), solid.membrane.points_mm.max(axis=0)
    assert low == pytest.approx([-15.0, -15.0, 0.0], abs=0.2)
    assert high == pytest.approx([15.0, 15.0, 25.0], abs=0.2)
    with pytest.raises(DesignError, match="stands on a point") as caught:
        build_imported(body, ImportedShape(), Layers())
    assert caught.value.at == "shape.cut_mm"


def test_turns_are_about_x_then_y_then_z(read_drum: ReadBody) -> None:
    """A drum lying along X is set up by -90 degrees about Y: the same membrane."""
    points, faces = drum()
    lying = body_of(points[:, [2, 0, 1]], faces)
    solid = build_imported(lying, ImportedShape(turn_y_deg=-90.0), Layers())
    upright = build_imported(read_drum, ImportedShape(), Layers())
    # The grid of marching cubes meets the turned facets at other places.
    assert solid.volume_mm3 == pytest.approx(upright.volume_mm3, rel=1e-3)
    assert np.ptp(solid.membrane.points_mm, axis=0)[2] == pytest.approx(HEIGHT_MM, abs=1e-5)


def test_picked_faces_become_regions(read_drum: ReadBody, hollow_drum: Solid) -> None:
    """The top of the drum, picked as actuator 1: pi 12^2 = 452 mm2, still outer."""
    surface = hollow_drum.membrane
    top = np.abs(surface.points_mm[surface.faces][:, :, 2] - HEIGHT_MM).max(axis=1) < 1e-6
    (patch,) = np.unique(hollow_drum.patches[top & surface.has(Label.OUTER)])
    pick = Pick(patch=int(patch), region="actuator_1")
    solid = build_imported(read_drum, ImportedShape(), Layers(), (pick,))
    found = areas(solid)
    assert found["actuator_1"] == pytest.approx(math.pi * 144.0, rel=2e-3)
    assert found["outer"] == pytest.approx(areas(hollow_drum)["outer"], rel=1e-9)
    as_base = build_imported(
        read_drum, ImportedShape(), Layers(), (dataclasses.replace(pick, region="base"),)
    )
    lost = areas(hollow_drum)["outer"] - areas(as_base)["outer"]
    assert lost == pytest.approx(math.pi * 144.0, rel=2e-3)


@pytest.mark.parametrize(
    "region", ["pin_1", "actuator_", "actuator_x", "actuator_²", "actuator_99999", "", "outer"]
)
def test_a_pick_must_be_base_or_a_numbered_actuator(region: str) -> None:
    """Anything else is refused with the choices."""
    with pytest.raises(DesignError, match="a picked face cannot be") as caught:
        Pick(patch=0, region=region)
    assert "actuator_0" in caught.value.hint


def test_the_last_sensing_face_keeps_its_side(read_drum: ReadBody) -> None:
    """All faces of the drum as base leave no sensing side: refused at the labels, no file named."""
    picks = tuple(
        Pick(patch=int(n), region="base")
        for n in np.unique(build_imported(read_drum, ImportedShape(), Layers()).patches)
        if n >= 0
    )
    with pytest.raises(DesignError, match="at least one face must stay sensing") as caught:
        build_imported(read_drum, ImportedShape(), Layers(), picks)
    assert caught.value.at == "body.picks"
    assert "file" not in f"{caught.value.message} {caught.value.hint}"


def test_a_pick_that_the_body_has_not_is_refused(read_drum: ReadBody) -> None:
    """Face 99 of a drum with three."""
    with pytest.raises(DesignError, match="picked face 99") as caught:
        build_imported(read_drum, ImportedShape(), Layers(), (Pick(patch=99, region="actuator_0"),))
    assert caught.value.at == "body.picks"


@pytest.mark.parametrize(
    ("layers", "shape", "at", "says"),
    [
        (
            {"elastomer_mm": 5.0, "support_mm": 4.0},
            {"cut_mm": 12.5},
            "layers.support_mm",
            "no room",
        ),
        ({"elastomer_mm": 6.0, "support_mm": 4.0}, {}, "layers.support_mm", "a camera needs 6 mm"),
        ({}, {"cut_mm": 20.0}, "shape.cut_mm", "leaves nothing of a body 20 mm high"),
        ({}, {"cut_mm": 99.0}, "shape.cut_mm", "leaves nothing"),
    ],
)
def test_walls_and_cuts_without_room_are_refused(
    read_drum: ReadBody, layers: dict[str, float], shape: dict[str, float], at: str, says: str
) -> None:
    """Each names the value, the limit and the field."""
    with pytest.raises(DesignError, match=says) as caught:
        build_imported(read_drum, ImportedShape(**shape), Layers(**layers))
    assert caught.value.at == at


def test_a_body_in_the_wrong_unit_is_refused_before_it_fills_the_memory() -> None:
    """A drum of 20 m: a grid of 0.4 mm around it would have 10^14 places."""
    points, faces = drum()
    body = read_body(
        ImportedBody(outer=body_file("o.stl", stl_bytes(points, faces)), unit=LengthUnit.M)
    )
    with pytest.raises(DesignError, match=r"2.4e\+04 mm long, more than 400 mm") as caught:
        build_imported(body, ImportedShape(), Layers())
    assert caught.value.at == "body.unit"


def test_an_inner_body_through_the_wall_is_refused() -> None:
    """11.9 mm in 12 mm leaves 0.1 mm of wall: less than can be cast."""
    with pytest.raises(DesignError, match=r"is 0\.\d+ mm at \(.*less than 0\.2 mm"):
        build_imported(body_of(*drum(), inner=drum(11.9, 15.0)), ImportedShape(), Layers())
    floating = drum(5.0, 5.0)
    with pytest.raises(DesignError, match="does not reach the base"):
        body = body_of(*drum(), inner=(floating[0] + [0.0, 0.0, 9.0], floating[1]))
        build_imported(body, ImportedShape(), Layers())


def test_distance_and_inside_of_a_drum() -> None:
    """On the axis at z = 8 the base is 8 mm away; 3 mm beyond the side is 3 mm and outside."""
    points, faces = drum()
    places = np.array([[0.0, 0.0, 8.0], [0.0, 0.0, 23.0], [15.0, 0.0, 10.0], [0.0, 0.0, 15.0]])
    assert distance_mm(points, faces, places) == pytest.approx([8.0, 3.0, 3.0, 5.0], abs=1e-5)
    assert inside(points, faces, places).tolist() == [True, False, False, True]


def test_inset_of_a_drum_is_a_drum() -> None:
    """2 mm in: radius 10, top at 18; its volume above the base is pi 10^2 18."""
    points, faces = drum()
    found, deepest_mm = inset_surface(points, faces, 2.0)
    assert found is not None
    assert deepest_mm > 2.0
    top, reach = found[0][:, 2].max(), np.linalg.norm(found[0][:, :2], axis=1).max()
    assert top == pytest.approx(18.0, abs=1e-3)
    assert reach == pytest.approx(10.0, abs=1e-2)
    nothing, deepest_mm = inset_surface(points, faces, 12.5)
    assert nothing is None
    # Searched on a grid of 0.5 mm.
    assert deepest_mm == pytest.approx(12.0, abs=0.5)


def test_isosurface_of_a_ball() -> None:
    """Radius 5 on a grid of 0.25 mm: closed, 4/3 pi r^3 to h^2 / r^2."""
    axis = np.arange(-6.0, 6.01, 0.25)
    x, y, z = np.meshgrid(axis, axis, axis, indexing="ij")
    found = isosurface(np.sqrt(x * x + y * y + z * z) - 5.0, [-6.0] * 3, 0.25)
    assert found is not None
    assert is_watertight(found[1])
    assert mesh_volume(*found) == pytest.approx(4 / 3 * math.pi * 125.0, rel=2.5e-3)
    assert isosurface(np.ones((3, 3, 3)), [0.0] * 3, 1.0) is None


def test_leds_of_a_body_from_a_file_are_moved_inside(hollow_drum: Solid) -> None:
    """Cavity of 9 mm less LED 1.1 mm and gaps 0.3 mm: 7.5 mm instead of 9; what fits stays."""
    design = SensorDesign(name="drum", family="imported")
    inside, notice = fitted(design, hollow_drum)
    assert inside.optics.ring.radius_mm == 7.5
    assert notice == "LED ring: radius 7.5 mm instead of 9 mm, to fit inside"
    assert fitted(inside, hollow_drum) == (inside, "")


def test_the_top_of_an_imported_body_is_pressed_first(hollow_drum: Solid) -> None:
    """In the middle of a drum's flat top, once the body is built; the origin until then."""
    design = SensorDesign(name="drum", family="imported")
    assert default_target_mm(design, hollow_drum) == pytest.approx((0.0, 0.0, HEIGHT_MM), abs=1e-3)
    assert default_target_mm(design) == (0.0, 0.0, 0.0)


def test_a_shell_open_at_its_foot_keeps_its_own_two_sides() -> None:
    """A domed column with a wall of 2.5 mm: that wall, whatever `layers.elastomer_mm` says.

    V = pi (13^2 23 + 2/3 13^3) - pi (10.5^2 23 + 2/3 10.5^3), less 0.2 % of chords.
    """
    made = cup(2.5)
    read = body_of(np.asarray(made.vertices), np.asarray(made.faces))
    solid = build_imported(read, ImportedShape(), Layers(elastomer_mm=1.0))
    exact = math.pi * ((13.0**2 - 10.5**2) * 23.0 + 2.0 / 3.0 * (13.0**3 - 10.5**3))
    assert solid.volume_mm3 == pytest.approx(exact, rel=5e-3)
    assert "is a shell already, 2.5 to 2.5 mm thick" in solid.notice
    for surface in (solid.membrane, solid.support, solid.base):
        assert is_watertight(surface.faces)


def test_a_thick_block_with_a_bore_is_no_shell() -> None:
    """A bore with less than a quarter of the volume is nobody's camera room: the wall is even."""
    import trimesh

    block = trimesh.creation.box((30.0, 30.0, 30.0))
    bore = trimesh.creation.cylinder(4.0, 20.0)
    bore.apply_translation((0.0, 0.0, -15.0))
    made = trimesh.boolean.difference([block, bore], engine="manifold")
    assert outer_and_inner(closed("b", np.add(made.vertices, [0, 0, 15.0]), made.faces)) is None


@pytest.mark.parametrize(("slot_mm", "said"), [(4.95, "is 0.05 mm at"), (7.0, "is -2 mm at")])
def test_a_slot_over_the_middle_of_a_flat_inside_is_measured(slot_mm: float, said: str) -> None:
    """Walls of 5 mm; a slot in the outside comes near to the core, or through it, where neither
    has a corner of the other's in reach. So does a body that is such a shell already."""
    outer, inner = slotted(slot_mm), block(30.0, 30.0, 25.0)
    with pytest.raises(DesignError, match=said):
        build_imported(body_of(*outer, inner=inner), ImportedShape(), Layers())
    shallow = build_imported(body_of(*slotted(3.0), inner=inner), ImportedShape(), Layers())
    assert shallow.notice == ""
    shell = boolean("difference", outer, inner)
    if slot_mm < 5.0:
        with pytest.raises(DesignError, match=said):
            build_imported(body_of(*shell), ImportedShape(), Layers())


def block(*size_mm: float) -> tuple[np.ndarray, np.ndarray]:
    """A box on z = 0."""
    import trimesh

    made = trimesh.creation.box(size_mm)
    return np.add(made.vertices, [0.0, 0.0, size_mm[2] / 2]), np.asarray(made.faces)


def boolean(kind: str, *bodies: tuple[np.ndarray, np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """Union or difference of bodies."""
    import trimesh

    made = getattr(trimesh.boolean, kind)([trimesh.Trimesh(*b) for b in bodies], engine="manifold")
    return np.asarray(made.vertices), np.asarray(made.faces)


def slotted(deep_mm: float) -> tuple[np.ndarray, np.ndarray]:
    """A box of 40 x 40 x 30 mm with a slot of 20 x 4 mm in the middle of one side."""
    points, faces = block(16.0, 20.0, 4.0)
    return boolean(
        "difference", block(40.0, 40.0, 30.0), (np.add(points, [28.0 - deep_mm, 0, 8]), faces)
    )


def test_a_narrow_cavity_has_no_way_in_for_a_camera() -> None:
    """A cavity of 4 x 40 mm is 4 mm wide, though its corners are 40 mm apart."""
    with pytest.raises(DesignError, match="is 4 mm wide about the middle"):
        build_imported(
            body_of(*block(14.0, 50.0, 30.0)),
            ImportedShape(),
            Layers(elastomer_mm=3.0, support_mm=2.0),
        )


def test_a_dish_is_aimed_at_on_its_rim() -> None:
    """The middle of a rim is in the air: the nearest place of the rim, 14 to 20 mm out."""
    import trimesh

    dish = trimesh.creation.cylinder(14.0, 10.0, sections=SIDES)
    hollow = boolean(
        "difference", drum(20.0, 30.0), (np.add(dish.vertices, [0, 0, 30.0]), dish.faces)
    )
    solid = build_imported(body_of(*hollow), ImportedShape(), Layers())
    x, y, z = default_target_mm(SensorDesign(name="dish", family="imported"), solid)
    assert z == pytest.approx(30.0, abs=0.02)
    assert 13.9 < math.hypot(x, y) < 20.0
