"""What a remesh by winding number gives, against closed forms, and how it is offered."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
import pytest
import trimesh

from geometry.intake.deviation import BETWEEN_STEPS, deviation
from geometry.intake.intake import read_body
from geometry.intake.repair import remeshed
from geometry.intake.solid_angles import CELLS, WindingNumber, _cluster_of_each
from geometry.intake.winding import grid_around, sampled, samples_of, winding_number
from geometry.surface.isosurface import distance_mm
from geometry.surface.meshlab import crossing_faces
from geometry.surface.surface import is_watertight, mesh_volume
from tests.foreign_bodies import FORTY, Foreign, cup, double_walled, written
from workbench.core.base.errors import DesignError
from workbench.core.design.imported import (
    ImportedBody,
    ReadBody,
    RepairOffer,
    body_file,
    body_table,
)
from workbench.project.bodies import read_body_table

BALL = trimesh.creation.icosphere(4, 15.0)
BALL_MM3 = float(BALL.volume)
BY_NAME = {foreign.name: foreign for foreign in FORTY}


def read(name: str, data: bytes, *, repair: bool = False) -> ReadBody:
    return read_body(ImportedBody(outer=body_file(name, data), repair=repair))


def exported(made: trimesh.Trimesh) -> bytes:
    return bytes(made.export(file_type="stl"))  # pyright: ignore[reportArgumentType]


def exact_winding(points: np.ndarray, faces: np.ndarray, places: np.ndarray) -> np.ndarray:
    """Sum of solid angles over 4 pi: van Oosterom and Strackee, 1983."""
    a, b, c = (points[faces[:, k]][None] - places[:, None] for k in range(3))
    x, y, z = (np.linalg.norm(corner, axis=2) for corner in (a, b, c))
    triple = np.einsum("qfi,qfi->qf", a, np.cross(b, c))
    below = (
        x * y * z
        + np.einsum("qfi,qfi->qf", a, b) * z
        + np.einsum("qfi,qfi->qf", b, c) * x
        + np.einsum("qfi,qfi->qf", c, a) * y
    )
    return 2.0 * np.arctan2(triple, below).sum(axis=1) / (4.0 * np.pi)


@pytest.mark.parametrize("cell_mm", [0.25, 1.0, 6.0])
def test_small_triangles_of_a_cell_are_one_cluster(cell_mm: float) -> None:
    """Two in each of the cells that the longest side is divided into: pairs, at any size."""
    begin = np.repeat(np.arange(CELLS), 2) + np.tile([0.0, 0.9], CELLS)
    triangle = np.array([[0.0, 0.0, 0.0], [0.1, 0.0, 0.0], [0.0, 0.1, 0.0]])
    corners = cell_mm * (triangle + begin[:, None, None] * [1.0, 0.0, 0.0])
    np.testing.assert_array_equal(_cluster_of_each(corners), np.repeat(np.arange(CELLS), 2))


@pytest.mark.parametrize("top_mm", [20.0, 5.0, 0.0])
def test_the_winding_number_is_the_sum_of_solid_angles(top_mm: float) -> None:
    """A whole ball, one without its cap, and a half: to 0.08 where no face is near."""
    faces = BALL.faces[BALL.triangles_center[:, 2] < top_mm]
    points = np.array(BALL.vertices)
    grid = grid_around(points[faces].reshape(-1, 3), 0.5)
    found = winding_number(*samples_of(points, faces, 0.35), grid)
    rng = np.random.default_rng(0)
    low, high = grid.low + 2.0, grid.low + 0.5 * (np.array(grid.size) - 1) - 2.0
    places = rng.uniform(low, high, (200, 3))
    places = places[distance_mm(points, faces, places) > 1.5]
    want = exact_winding(points, faces, places)
    assert np.abs(sampled(found, grid, places) - want).max() < 0.08


@pytest.mark.parametrize("step_mm", [0.6, 2.0])
def test_a_closed_ball_winds_once_about_its_inside(step_mm: float) -> None:
    """1 inside and 0 outside, on a fine and on a coarse grid."""
    points, faces = np.array(BALL.vertices), np.array(BALL.faces)
    grid = grid_around(points, step_mm)
    found = winding_number(*samples_of(points, faces, step_mm / 1.5), grid)
    reach = np.linalg.norm(points, axis=1).max()
    middle = sampled(found, grid, np.array([[0.0, 0.0, 0.0], [0.0, 0.3 * reach, 0.0]]))
    beside = sampled(found, grid, reach * np.array([[1.4, 0.0, 0.0], [0.0, 0.0, -1.4]]))
    np.testing.assert_allclose(middle, 1.0, atol=0.06)
    np.testing.assert_allclose(beside, 0.0, atol=0.06)


def test_samples_hold_the_area_of_long_and_of_small_triangles() -> None:
    """A blade of 60 x 0.5 and a speck: areas add up, places are near and few."""
    points = np.array(
        [[0, 0, 0], [60, 0, 0], [60, 0.5, 0], [5, 5, 1], [5.01, 5, 1], [5, 5.01, 1.0]]
    )
    faces = np.array([[0, 1, 2], [3, 4, 5]])
    places, areas = samples_of(points, faces, 0.4)
    assert areas.sum(axis=0) == pytest.approx([0.0, 0.0, 15.0 + 5e-5])
    assert len(places) < 1000
    gaps = np.diff(np.sort(places[places[:, 2] == 0.0][:, 0]))
    assert gaps.max() < 0.6


@pytest.mark.parametrize("beside_mm", [1e-4, 0.03, 3.0])
def test_the_winding_number_at_places_holds_beside_faces(beside_mm: float) -> None:
    """A ball without its cap: clusters far off count as dipoles, to 0.01."""
    kept = BALL.triangles_center[:, 2] < 12.0
    points, faces = np.array(BALL.vertices), BALL.faces[kept]
    middle, up = BALL.triangles_center[kept][::40], BALL.face_normals[kept][::40]
    places = np.vstack([middle + beside_mm * up, middle - beside_mm * up])
    want = exact_winding(points, faces, places)
    assert np.abs(WindingNumber(points, faces).at(places) - want).max() < 0.01


@pytest.mark.parametrize("thick_mm", [0.3, 0.03])
@pytest.mark.parametrize("slot", [False, True])
def test_a_thin_fin_or_slot_that_is_lost_is_in_the_stated_deviation(
    slot: bool, thick_mm: float
) -> None:
    """10 x 10 mm and 0.3 mm thick on a block of 40 x 40 x 20, which another block cuts through."""
    block = trimesh.creation.box((40.0, 40.0, 20.0))
    blade = trimesh.creation.box((10.0, thick_mm, 20.0))
    blade.apply_translation((0.0, 0.0, 10.0))
    cut = trimesh.boolean.difference if slot else trimesh.boolean.union
    other = trimesh.creation.box((10.0, 10.0, 10.0))
    other.apply_translation((20.0, 0.0, 0.0))
    made: Any = trimesh.util.concatenate([cut([block, blade], engine="manifold"), other])
    with pytest.raises(DesignError, match=r"bodies|cut through") as caught:
        read("blade.stl", exported(made))
    offer = caught.value.repair
    found = remeshed(np.array(made.vertices), np.asarray(made.faces))
    assert found is not None
    off_mm = distance_mm(found.points, found.faces, np.array(made.vertices)).max()
    assert off_mm > 9.0
    assert off_mm <= offer.deviation_mm < off_mm + 0.1
    x, y, z = offer.farthest
    assert abs(x) <= 5.0 and abs(y) <= 0.2 and (z < 1.0 if slot else z > 19.0)
    assert "mm, because what is thinner than about 0.7" in offer.words


def test_a_lid_hides_no_deviation_elsewhere() -> None:
    """A block without its top, closed, and a needle of 0.8 mm on its foot that the file lacks."""
    block = trimesh.creation.box((20.0, 20.0, 20.0))
    file = np.array(block.vertices), block.faces[block.triangles_center[:, 2] < 9.0]
    needle = trimesh.creation.box((0.02, 0.02, 1.6))
    needle.apply_translation((3.0, 4.0, -10.0))
    made: Any = trimesh.boolean.union([block, needle], engine="manifold")
    closed = np.array(made.vertices), np.asarray(made.faces)
    found = deviation(file, closed, samples_of(*file, 0.7), 1.0)
    assert found.largest == pytest.approx(0.8 + BETWEEN_STEPS)
    assert found.place == pytest.approx((3.0, 4.0, -10.8), abs=0.02)
    assert found.hole > 3.0


def test_a_stated_deviation_is_rounded_up() -> None:
    """9.82 mm is not at most 9.8 mm."""
    for mm, said in ((10.04, "10.1"), (9.82, "9.9"), (0.3, "0.3"), (0.0401, "0.041"), (0.0, "0")):
        offer = RepairOffer(step_mm=20.0, deviation_mm=mm, farthest=(0.0, 0.0, 0.0), closed_mm=0.0)
        assert offer.words.endswith(f"deviation at most {said} mm")


@pytest.mark.parametrize(
    ("name", "off_steps"), [("crossing_2.stl", 2.0), ("holes_6.stl", 2.0), ("crossing_3.stl", 6.0)]
)
def test_a_remesh_is_closed_simple_and_as_near_as_it_says(name: str, off_steps: float) -> None:
    """Doubled faces, cracks and a knot: what is measured from outside is what is stated.

    The fold of the knot is inside out and is lost: five steps.
    """
    foreign = BY_NAME[name]
    made = trimesh.load_mesh(trimesh.util.wrap_as_stream(written(foreign)), file_type="stl")
    points, faces = np.asarray(made.vertices, np.float64), np.asarray(made.faces)
    found = remeshed(points, faces)
    assert found is not None
    assert found.bodies == 1
    assert is_watertight(found.faces)
    assert not crossing_faces(found.points, found.faces).any()
    off = distance_mm(points, faces, found.points)
    assert off.max() <= max(found.deviation, found.closed_width) + 1e-6
    assert found.deviation < off_steps * found.step


def test_two_overlapping_blocks_hold_what_their_union_does() -> None:
    """Blocks of 20 x 20 x 20 mm that share a half: 12,000 mm3, edges cut by parts of a step."""
    block = trimesh.creation.box((20.0, 20.0, 20.0))
    other = block.copy()
    other.apply_translation((0.0, 0.0, 10.0))
    data = exported(trimesh.util.concatenate([block, other]))
    with pytest.raises(DesignError, match=r"pair\.stl holds 2 bodies") as caught:
        read("pair.stl", data)
    offer = caught.value.repair
    assert 0.0 < offer.deviation_mm < 0.5
    assert offer.closed_mm == 0.0
    assert f"run again with --repair: {offer.words}" in caught.value.hint
    body = read("pair.stl", data, repair=True)
    assert mesh_volume(body.outer.points_mm, body.outer.faces) == pytest.approx(12000.0, rel=5e-3)
    assert offer.words in body.notice
    assert "pair.stl" not in body.notice
    assert read("twin.stl", data, repair=True).notice == body.notice


def test_a_hole_is_closed_and_its_width_told() -> None:
    """A ball without its cap 18 mm wide: a film spans it, the volume between cut and whole ball."""
    kept = BALL.copy()
    kept.update_faces(~(kept.triangles_center[:, 2] > 12.0))
    # Nothing flat: one vertex of the rim is out of its plane.
    points = np.array(kept.vertices)
    rim = np.argsort(np.abs(points[:, 2] - 12.0))[:1]
    points[rim, 2] -= 0.5
    data = exported(trimesh.Trimesh(points, kept.faces, process=False))
    with pytest.raises(DesignError, match="is open: a hole") as caught:
        read("bowl.stl", data)
    assert 8.0 < caught.value.repair.closed_mm < 25.0
    body = read("bowl.stl", data, repair=True)
    cap_mm3 = np.pi * 3.0**2 * (3 * 15.0 - 3.0) / 3
    held = mesh_volume(body.outer.points_mm, body.outer.faces)
    assert BALL_MM3 - 2 * cap_mm3 < held < BALL_MM3


def test_a_sound_file_is_not_touched_by_an_accepted_repair() -> None:
    """`repair = true` is leave, not an order."""
    body = read("ball.stl", exported(BALL), repair=True)
    assert len(body.outer.faces) == len(BALL.faces)
    assert body.notice == ""


def test_two_balls_apart_are_refused_without_an_offer() -> None:
    """No remesh makes one body of them."""
    foreign = BY_NAME["crossing_8.stl"]
    for repair in (False, True):
        with pytest.raises(DesignError, match="holds 2 bodies") as caught:
            read(foreign.name, written(foreign), repair=repair)
        assert caught.value.repair is None
        assert "--repair" not in caught.value.hint


def test_a_double_walled_body_has_its_own_inner_side() -> None:
    """A ball of 16 mm in which one of 13 mm is hollow: the two sides, said once."""
    body = read("shell.stl", exported(double_walled()))
    assert body.inner is not None
    # Icospheres of 5,120 faces hold 0.2 % less than their balls.
    for surface, radius_mm in ((body.outer, 16.0), (body.inner, 13.0)):
        want = 4.0 / 3.0 * np.pi * radius_mm**3
        assert mesh_volume(surface.points_mm, surface.faces) == pytest.approx(want, rel=4e-3)
    assert body.notice == "outer body: it is a shell already, so its two sides are used"


def cad(number: int) -> Foreign:
    return BY_NAME[f"cad_{number}.step"]


@pytest.mark.parametrize("number", [0, 3])
def test_loose_faces_of_a_step_are_sewn(number: int) -> None:
    """A shell without its solid, and faces 0.002 mm apart: closed, and said."""
    body = read(cad(number).name, written(cad(number)))
    assert is_watertight(body.outer.faces)
    assert "loose faces were sewn" in body.notice


def test_loose_faces_too_far_apart_are_offered_a_remesh() -> None:
    """A cone on a plate whose faces are 0.05 mm out: refused, then remeshed near its volume."""
    foreign = cad(4)
    with pytest.raises(DesignError, match=r"do not meet within 0\.01 mm") as caught:
        read(foreign.name, written(foreign))
    assert caught.value.repair is not None
    body = read(foreign.name, written(foreign), repair=True)
    # The plate ends 1 mm within the cone, where 13.8 mm of radius are in both.
    cone_mm3 = np.pi * 28.0 / 3 * (14**2 + 14 * 9 + 9**2)
    want = cone_mm3 + np.pi * (6 * 16**2 - (14**2 + 14 * 13.82 + 13.82**2) / 3)
    assert mesh_volume(body.outer.points_mm, body.outer.faces) == pytest.approx(want, rel=0.03)


def test_acceptance_is_kept_in_the_design_file(tmp_path: object) -> None:
    """`repair` goes through the table, refuses other types, and makes another key."""
    from pathlib import Path

    from workbench.core.base.digest import digest

    folder = Path(str(tmp_path))
    (folder / "a.stl").write_bytes(exported(cup()))
    plain = read_body_table({"outer": "a.stl"}, roots=(folder,))
    assert plain.repair is False
    asked = read_body_table({"outer": "a.stl", "repair": True}, roots=(folder,))
    assert body_table(asked)["repair"] is True
    assert digest(asked) != digest(plain) == digest(dataclasses.replace(asked, repair=False))
    with pytest.raises(DesignError, match=r"body\.repair is 'yes'"):
        read_body_table({"outer": "a.stl", "repair": "yes"}, roots=(folder,))
