"""Pixels of points through the refracting wall, and rays through walls that are not convex."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from sim.optics.camera.camera import project, refracted_rays
from sim.optics.camera.projection import FOUND_MM, _meet, open_map, project_points, seeds
from sim.optics.camera.refraction import refract
from sim.optics.camera.walls import last_segments
from sim.optics.proof.specimen import finger
from sim.specimens import skins_only
from tests.unit.test_raster import TILTED, grooved
from workbench.core.design.camera import Camera, LensModel
from workbench.core.result.results import MembraneMesh, Skin

SMALL = Camera(width_px=160, height_px=120)
HUNDREDTH_PX = 0.01


@pytest.fixture(scope="module")
def mesh() -> MembraneMesh:
    return finger(edge_mm=0.6)


def miss(foot: np.ndarray, way: np.ndarray, point: np.ndarray) -> np.ndarray:
    offset = point - foot
    return offset - (offset @ way) / (way @ way) * way


def test_newton_finds_the_pixel_that_bisection_finds(mesh: MembraneMesh) -> None:
    """Along the image's middle row and column both agree to a hundredth of a pixel."""
    ray_map = open_map(mesh, SMALL, index=1.41)
    row = ray_map.pad_px + 60
    # Points on the plane of symmetry through the row are those half way between two rows' rays.
    foot = 0.5 * (ray_map.foot_mm[row - 1] + ray_map.foot_mm[row]).astype(np.float64)
    way = 0.5 * (ray_map.direction[row - 1] + ray_map.direction[row]).astype(np.float64)
    columns = ray_map.pad_px + np.array([20.3, 61.7, 80.5, 118.2, 140.9])
    for column in columns:
        left, share = int(column), column % 1.0
        here = (1 - share) * foot[left] + share * foot[left + 1]
        along = (1 - share) * way[left] + share * way[left + 1]
        point = here + 30.0 * along / np.linalg.norm(along)
        low, high = column - 5.0, column + 5.0
        for _ in range(60):
            middle = 0.5 * (low + high)
            cell, part = int(middle), middle % 1.0
            from_foot = (1 - part) * foot[cell] + part * foot[cell + 1]
            toward = (1 - part) * way[cell] + part * way[cell + 1]
            if miss(from_foot, toward, point)[0] > 0.0:
                low = middle
            else:
                high = middle
        found = project_points(ray_map, point[None], np.array([[column - 4.0, row + 3.0]]))
        assert found.xy[0] == pytest.approx([0.5 * (low + high), row - 0.5], abs=HUNDREDTH_PX)


@pytest.mark.parametrize("lens", list(LensModel))
def test_without_refraction_newton_is_the_lens_model(mesh: MembraneMesh, lens: LensModel) -> None:
    """At index 1 the map's pixel is that of `camera.project`."""
    camera = dataclasses.replace(SMALL, lens=lens, fov_x_deg=90.0)
    ray_map = open_map(mesh, camera, index=1.0)
    points = mesh.outer.points_mm
    found = project_points(ray_map, points, seeds(ray_map, points))
    exact = project(camera, points)
    inside = (exact > 1.0).all(axis=1) & (exact < [159.0, 119.0]).all(axis=1)
    assert inside.sum() > 3000
    gap = np.linalg.norm(found.xy + 0.5 - ray_map.pad_px - exact, axis=1)[inside]
    # Directions bilinear over pixels of 0.6 degrees err by 0.6 deg^2 / 8 = 1e-5 rad = 1e-3 px.
    assert gap.max() < HUNDREDTH_PX


def test_projected_vertices_lie_on_their_rays(mesh: MembraneMesh) -> None:
    """Three steps from the nearest pixel leave 1e-3 px; most vertices are in the map."""
    ray_map = open_map(mesh, SMALL, index=1.41)
    points = mesh.outer.points_mm
    start = seeds(ray_map, points)
    settled = project_points(ray_map, points, start)
    known = settled.miss_mm < FOUND_MM
    assert known.mean() > 0.6
    quick = project_points(ray_map, points[known], start[known], steps=3)
    assert np.linalg.norm(quick.xy - settled.xy[known], axis=1).max() < 1e-3


def test_map_rays_are_those_of_the_camera(mesh: MembraneMesh) -> None:
    """On a convex wall the walls' rays equal `refracted_rays`, bit by bit."""
    rays = open_map(mesh, SMALL, index=1.41).rays
    single = refracted_rays(SMALL, mesh.cavity, 1.41)
    assert np.array_equal(rays.origin_mm, single.origin_mm)
    assert np.array_equal(rays.direction, single.direction)
    assert np.array_equal(rays.transmittance, single.transmittance)


def plate(height_mm: float, up: float) -> Skin:
    """A large square at a height, its normals along +Z or -Z."""
    corners = np.array([[-90.0, -80.0], [90.0, -80.0], [90.0, 80.0], [-90.0, 80.0]])
    points = np.column_stack([corners, np.full(4, height_mm)])
    faces = np.array([[0, 1, 2], [0, 2, 3]], dtype=np.int32)
    normals = np.tile([0.0, 0.0, up], (4, 1))
    return Skin(points_mm=points, faces=faces if up > 0 else faces[:, ::-1], normals=normals)


def stacked(*skins: Skin) -> Skin:
    """Several skins as one."""
    offset = np.cumsum([0, *(len(skin.points_mm) for skin in skins[:-1])])
    return Skin(
        points_mm=np.concatenate([skin.points_mm for skin in skins]),
        faces=np.concatenate(
            [skin.faces + start for skin, start in zip(skins, offset, strict=True)]
        ),
        normals=np.concatenate([skin.normals for skin in skins]),
    )


def test_the_first_triangle_is_met_like_any_other() -> None:
    """One ray into triangle 0, one into triangle 1, and one that goes the other way."""
    ways = np.array([[0.3, -0.3, 1.0], [-0.3, 0.3, 1.0], [0.0, 0.0, -1.0]])
    ways /= np.linalg.norm(ways, axis=1, keepdims=True)
    skin = plate(20.0, 1.0)
    segments = last_segments(ways, np.zeros(3), cavity=plate(10.0, 1.0), seen=skin, index=1.0)
    hit, face = _meet(skin, segments)
    np.testing.assert_array_equal(face, [0, 1, -1])
    np.testing.assert_allclose(hit[:2], [[6.0, -6.0, 20.0], [-6.0, 6.0, 20.0]], atol=1e-4)
    assert np.isnan(hit[2]).all()


def test_rays_cross_every_wall_before_the_skin() -> None:
    """Through a slab and air into a block: Snell three times, Fresnel's product, exact places."""
    cavity = stacked(plate(10.0, 1.0), plate(14.0, -1.0), plate(20.0, 1.0))
    angle = np.radians(30.0)
    direction = np.array([[np.sin(angle), 0.0, np.cos(angle)]])
    found = last_segments(direction, np.zeros(3), cavity=cavity, seen=plate(30.0, 1.0), index=1.41)
    inside = np.arcsin(np.sin(angle) / 1.41)
    place = 10.0 * np.tan(angle) + 4.0 * np.tan(inside) + 6.0 * np.tan(angle)
    assert found.walls[0] == 3
    assert found.origin_mm[0] == pytest.approx([place, 0.0, 20.0], abs=1e-9)
    assert found.direction[0] == pytest.approx([np.sin(inside), 0.0, np.cos(inside)], abs=1e-12)
    up = np.array([[0.0, 0.0, 1.0]])
    inward = refract(direction, up, index_from=1.0, index_to=1.41)
    outward = refract(inward[0], up, index_from=1.41, index_to=1.0)
    assert found.transmittance[0] == pytest.approx(inward[1][0] ** 2 * outward[1][0], rel=1e-12)
    length = 16.0 / np.cos(angle) + 4.0 / np.cos(inside)
    assert found.travelled_mm[0] == pytest.approx(length, abs=1e-9)


def test_a_ray_stops_at_skin_between_the_walls() -> None:
    """Skin inside the slab ends the ray after one wall."""
    cavity = stacked(plate(10.0, 1.0), plate(14.0, -1.0), plate(20.0, 1.0))
    up = np.array([[0.0, 0.0, 1.0]])
    found = last_segments(up, np.zeros(3), cavity=cavity, seen=plate(12.0, 1.0), index=1.41)
    assert found.walls[0] == 1 and found.origin_mm[0, 2] == pytest.approx(10.0)


def test_total_reflection_ends_a_ray_in_darkness() -> None:
    """From the block into air at 50 degrees, beyond the critical 45.2: transmittance 0."""
    slope = np.radians(50.0)
    wedge = plate(14.0, -1.0)
    turn = np.array(
        [[np.cos(slope), 0, np.sin(slope)], [0, 1, 0], [-np.sin(slope), 0, np.cos(slope)]]
    )
    middle = np.array([0.0, 0.0, 14.0])
    tilted = Skin(
        points_mm=(wedge.points_mm - middle) @ turn.T + middle,
        faces=wedge.faces,
        normals=wedge.normals @ turn.T,
    )
    cavity = stacked(plate(10.0, 1.0), tilted)
    up = np.array([[0.0, 0.0, 1.0]])
    found = last_segments(up, np.zeros(3), cavity=cavity, seen=plate(200.0, 1.0), index=1.41)
    assert found.transmittance[0] == 0.0 and found.walls[0] == -1


def test_a_groove_makes_rays_cross_three_walls_and_folds_few_pixels() -> None:
    """A ridge in the cavity: some rays leave and enter again; flagged pixels stay a minority."""
    mesh = grooved()
    ray_map = open_map(mesh, TILTED, index=1.41)
    assert ray_map.folded.any() and ray_map.folded.mean() < 0.1
    smooth = skins_only(outer=mesh.outer, inner=mesh.inner, cavity=finger(edge_mm=0.8).cavity)
    assert open_map(smooth, SMALL, index=1.0).folded.mean() == 0.0
