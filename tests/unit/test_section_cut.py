"""Cuts of bodies whose sections are known: areas, lengths and what is left are exact."""

from __future__ import annotations

import math

import numpy as np
import pytest

from workbench.core.result.results import MembraneMesh, Solid
from workbench.core.result.sensing import Contact
from workbench.view.section_cut import Axis, Plane, PressedBody, cap, clip, closed_loops, packed


def cube(edge_mm: float = 2.0) -> tuple[np.ndarray, np.ndarray]:
    """A cube about the origin."""
    import trimesh

    mesh = trimesh.creation.box((edge_mm, edge_mm, edge_mm))
    return np.asarray(mesh.vertices), np.asarray(mesh.faces)


def area_mm2(points: np.ndarray, faces: np.ndarray) -> float:
    """Area of triangles."""
    a, b, c = (points[faces[:, k]] for k in range(3))
    return float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2)


@pytest.mark.parametrize("axis", list(Axis))
@pytest.mark.parametrize("flip", [False, True])
def test_half_a_cube(axis: Axis, flip: bool) -> None:
    """An edge of 2 mm cut at 0.5: section 4 mm2, outline 8 mm, side walls of 1.5 or 0.5 mm."""
    plane = Plane(axis=axis, position_mm=0.5, flip=flip)
    clipped = clip(*cube(), plane)
    filled = cap(clipped, plane)
    assert filled.area_mm2 == pytest.approx(4.0)
    # The triangles cover the section once: a hole filled or a flipped triangle would change it.
    assert area_mm2(filled.points_mm, filled.faces) == pytest.approx(4.0)
    length = np.linalg.norm(np.diff(clipped.outline_mm, axis=1), axis=2).sum()
    assert length == pytest.approx(8.0)
    height = 0.5 if flip else 1.5
    assert area_mm2(clipped.points_mm, clipped.faces) == pytest.approx(4.0 + 8.0 * height)
    along = clipped.points_mm[clipped.faces][..., axis.number]
    assert (along.min() > 0.5 - 1e-9) if flip else (along.max() < 0.5 + 1e-9)


@pytest.mark.parametrize(("position_mm", "cap_mm2"), [(1.0, 0.0), (-1.0, 4.0)])
@pytest.mark.parametrize("flip", [False, True])
def test_what_lies_in_the_plane_is_kept(position_mm: float, cap_mm2: float, flip: bool) -> None:
    """In the face beyond the cube: all of it, closed as it was, without a cap. In the face on this
    side: that face alone, closed by a cap of its 4 mm2."""
    plane = Plane(axis=Axis.Z, position_mm=-position_mm if flip else position_mm, flip=flip)
    clipped = clip(*cube(), plane)
    filled = cap(clipped, plane)
    assert filled.area_mm2 == pytest.approx(cap_mm2)
    left_mm2 = area_mm2(clipped.points_mm, clipped.faces)
    # Walls as high as what counts as touching stand between face and cap: nothing to a part in 1e6.
    assert left_mm2 == pytest.approx(4.0 if cap_mm2 else 24.0)


def test_a_plane_through_vertices_of_two_bodies_caps_both() -> None:
    """Two cubes one above the other, cut through the middles of their faces: 4 mm2 each."""
    points, faces = cube()
    plane = Plane(axis=Axis.X, position_mm=0.0)
    stacked = np.concatenate([points, points + np.array([0.0, 0.0, 4.0])])
    both = np.concatenate([faces, faces + len(points)])
    assert cap(clip(stacked, both, plane), plane).area_mm2 == pytest.approx(8.0)


def test_a_hollow_section_keeps_its_hole() -> None:
    """A shell of spheres of 3 and 2 mm cut through the middle: pi (9 - 4) mm2, to 1 %."""
    import trimesh

    outer = trimesh.creation.icosphere(subdivisions=4, radius=3.0)
    inner = trimesh.creation.icosphere(subdivisions=4, radius=2.0)
    points = np.concatenate([outer.vertices, inner.vertices])
    faces = np.concatenate([outer.faces, inner.faces[:, ::-1] + len(outer.vertices)])
    plane = Plane(axis=Axis.Y, position_mm=0.01)
    filled = cap(clip(points, faces, plane), plane)
    # A sphere of 2562 vertices lies 0.3 % inside its circle.
    assert filled.area_mm2 == pytest.approx(5.0 * math.pi, rel=0.01)
    assert area_mm2(filled.points_mm, filled.faces) == pytest.approx(filled.area_mm2)


def test_values_are_carried_to_the_cut() -> None:
    """A value equal to 3 x + 1 stays so at every corner of the cut."""
    points, faces = cube()
    clipped = clip(points, faces, Plane(axis=Axis.Z, position_mm=0.3))
    value = clipped.carry(3.0 * points[:, 0] + 1.0)
    assert value == pytest.approx(3.0 * clipped.points_mm[:, 0] + 1.0)


def test_open_outlines_are_left_out() -> None:
    """A loop of three and a chain of two: one loop."""
    loops = closed_loops(np.array([[0, 1], [1, 2], [2, 0], [5, 6], [6, 7]]))
    assert [sorted(loop) for loop in loops] == [[0, 1, 2]]


def test_all_or_nothing_is_cut() -> None:
    """A plane beside the body leaves all of it, or nothing, and no cap."""
    points, faces = cube()
    for position_mm, left in ((9.0, 12), (-9.0, 0)):
        plane = Plane(axis=Axis.Y, position_mm=position_mm)
        clipped = clip(points, faces, plane)
        assert len(clipped.faces) == left
        assert not len(cap(clipped, plane).faces)
        assert len(packed(clipped.points_mm, clipped.faces)[0]) == (8 if left else 0)


def test_finger_section_has_the_volume_of_its_layers(finger: Solid) -> None:
    """The membrane's sections along Y, summed up, are its volume, to 1 %."""
    low, high = finger.membrane.points_mm[:, 1].min(), finger.membrane.points_mm[:, 1].max()
    steps = 60
    middles = low + (np.arange(steps) + 0.5) * (high - low) / steps
    areas = []
    for position_mm in middles:
        plane = Plane(axis=Axis.Y, position_mm=float(position_mm))
        clipped = clip(finger.membrane.points_mm, finger.membrane.faces, plane)
        areas.append(cap(clipped, plane).area_mm2)
    # The midpoint rule on 60 sections of a shell whose wall appears at once at both ends.
    assert sum(areas) * (high - low) / steps == pytest.approx(7210.98, rel=0.01)


def test_a_pressed_membrane_follows_its_skin(finger: Solid, finger_mesh: MembraneMesh) -> None:
    """All of the outer skin 0.4 mm along X: outer vertices go 0.4 mm, those of the foot none."""
    zeros = np.zeros((1, 3))
    way = np.zeros((1, len(finger_mesh.outer.points_mm), 3))
    way[..., 0] = 0.4
    contact = Contact(
        displacement_mm=way,
        reaction_N=zeros,
        moment_Nmm=zeros,
        indenter_pose=np.zeros((1, 7)),
        residual=np.zeros(1),
        penetration_mm=np.zeros(1),
        support_N=zeros,
        cut_N=zeros,
        friction_ratio=np.zeros(1),
        sliding=np.zeros((1, 0), bool),
        target_mm=np.zeros(3),
        normal=np.zeros(3),
        tangent_u=np.zeros(3),
        grid_mm=1.0,
        active_radius_mm=1.0,
        particles=0,
        substeps=0,
        device="cpu",
    )
    body = PressedBody(finger.membrane, finger_mesh)
    moved = body.points_mm(contact, 0) - finger.membrane.points_mm
    # The skin's weights add up to one.
    assert np.unique(np.round(moved[:, 0], 9)).tolist() == [0.0, 0.4]
    assert not moved[:, 1:].any()


def test_bodies_that_touch_along_an_edge_have_a_loop_each() -> None:
    """Two squares that share corner 0, chained as one way: two loops, of areas 1 and 1."""
    segments = np.array([(0, 1), (1, 2), (2, 3), (3, 0), (0, 4), (4, 5), (5, 6), (6, 0)])
    loops = closed_loops(segments)
    assert sorted(sorted(loop.tolist()) for loop in loops) == [[0, 1, 2, 3], [0, 4, 5, 6]]
    open_chain = np.array([(0, 1), (1, 2), (2, 0), (7, 8), (8, 9)])
    assert [sorted(loop.tolist()) for loop in closed_loops(open_chain)] == [[0, 1, 2]]
