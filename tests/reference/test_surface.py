"""Mesh queries against spheres, boxes and brute force."""

from __future__ import annotations

import math

import numpy as np
import pytest

from geometry.surface.primitives import rounded_box, sphere
from geometry.surface.surface import (
    Plane,
    RayCaster,
    closest_point,
    face_areas,
    half_space_clip,
    is_watertight,
    mesh_volume,
    open_edges,
    section_outline,
    vertex_normals,
)

CUBE = rounded_box(5.0, 0.0)
BALL = sphere(3.0)


def random_rays(count: int) -> tuple[np.ndarray, np.ndarray]:
    generator = np.random.default_rng(1)
    directions = generator.normal(size=(count, 3))
    return generator.uniform(-1.0, 1.0, (count, 3)), directions


def test_cube_volume_area_and_closedness() -> None:
    """1000 mm3, 600 mm2, no open edge; 3 open edges per missing triangle; inside out -1000."""
    points, faces = CUBE
    assert mesh_volume(points, faces) == pytest.approx(1000.0, rel=1e-12)
    assert mesh_volume(points, faces[:, ::-1]) == pytest.approx(-1000.0, rel=1e-12)
    assert face_areas(points, faces).sum() == pytest.approx(600.0, rel=1e-12)
    assert is_watertight(faces)
    assert open_edges(faces[1:]) == 3
    assert not is_watertight(faces[:0])
    flipped = faces.copy()
    flipped[0] = flipped[0, ::-1]
    assert not is_watertight(flipped)


def test_normals_of_a_cube_do_not_depend_on_its_diagonals() -> None:
    """(1, 1, 1) / sqrt 3 at each corner."""
    points, faces = CUBE
    assert vertex_normals(points, faces) == pytest.approx(np.sign(points) / math.sqrt(3), abs=1e-12)


def test_rays_meet_the_planes_of_a_cube_exactly() -> None:
    """Distance to the nearest of six planes, in float64 although Embree has float32."""
    origins, directions = random_rays(2000)
    distance, face, weights = RayCaster(*CUBE).hits(origins, directions)
    exact = ((np.sign(directions) * 5.0 - origins) / directions).min(axis=1)
    # Origins are rounded to float32 only while searching.
    assert distance == pytest.approx(exact, rel=1e-12)
    points, faces = CUBE
    place = np.einsum("ri,rij->rj", weights, points[faces[face]])
    # Beside an edge Embree may name the neighbour, whose weights are clipped: float32 at 5 mm.
    assert place == pytest.approx(origins + distance[:, None] * directions, abs=1e-5)


def test_misses_are_marked() -> None:
    """A ray away from the cube: inf, face -1, weights 0."""
    distance, face, weights = RayCaster(*CUBE).hits(
        np.array([[9.0, 0, 0]]), np.array([[1.0, 0, 0]])
    )
    assert distance[0] == np.inf
    assert face[0] == -1
    assert not weights.any()


def test_occlusion_ends_at_the_distance_asked_for() -> None:
    """From the centre of the cube the wall is at 5 mm."""
    caster, start = RayCaster(*CUBE), np.zeros((2, 3))
    along = np.array([[1.0, 0.1, 0.2], [0.1, -1.0, 0.3]])
    assert caster.occluded(start, along, 5.1).all()
    assert not caster.occluded(start, along, 4.9).any()
    assert caster.occluded(start, along, np.array([4.9, 5.1])).tolist() == [False, True]


def test_closest_point_agrees_with_brute_force() -> None:
    """The nearest of dense samples is never nearer than the answer, nor 0.03 mm farther."""
    generator = np.random.default_rng(2)
    query = generator.uniform(-5.0, 5.0, (80, 3))
    points, faces = BALL
    place, distance, face = closest_point(points, faces, query)
    assert np.linalg.norm(query - place, axis=1) == pytest.approx(distance)
    weights = generator.dirichlet([1, 1, 1], size=(len(faces), 40))
    samples = np.einsum("fsi,fij->fsj", weights, points[faces]).reshape(-1, 3)
    nearest = np.array([np.linalg.norm(samples - q, axis=1).min() for q in query])
    assert (nearest >= distance - 1e-9).all()
    # Samples lie about 0.02 mm apart, so they overestimate by less than that.
    assert (nearest - distance).max() < 0.03
    first, second, third = points[faces[face]].transpose(1, 0, 2)
    height = np.einsum("ij,ij->i", place - first, np.cross(second - first, third - first))
    assert np.abs(height).max() < 1e-9


def test_closest_point_with_long_thin_triangles() -> None:
    """On a cube of two triangles a side: the clamped query, exactly."""
    query = np.random.default_rng(3).uniform(5.5, 20.0, (200, 3)) * [1.0, -1.0, 1.0]
    place, distance, _ = closest_point(*CUBE, query)
    exact = np.clip(query, -5.0, 5.0)
    assert place == pytest.approx(exact, abs=1e-9)
    assert distance == pytest.approx(np.linalg.norm(query - exact, axis=1))


def test_section_of_a_cube_is_a_square() -> None:
    """40 mm around, all on the plane z = 1, and the same through its vertices."""
    outline = section_outline(*CUBE, Plane((0.0, 0.0, 1.0), (0.0, 0.0, 1.0)))
    length = np.linalg.norm(outline[:, 1] - outline[:, 0], axis=1).sum()
    assert length == pytest.approx(40.0)
    assert outline[:, :, 2] == pytest.approx(1.0)
    assert section_outline(*CUBE, Plane((0, 0, 9.0), (0.0, 0.0, 1.0))).shape == (0, 2, 3)


def test_clip_keeps_half_the_area_and_carries_values() -> None:
    """Half a ball's area, 2 pi r^2 = 56.55 mm2; values linear in space stay so."""
    points, faces = BALL
    clip = half_space_clip(points, faces, Plane((0.0, 0.0, 0.3), (0.0, 0.0, 2.0)))
    whole = face_areas(points, faces).sum()
    other = half_space_clip(points, faces, Plane((0.0, 0.0, 0.3), (0.0, 0.0, -2.0)))
    parts = [face_areas(part.points_mm, part.faces).sum() for part in (clip, other)]
    assert sum(parts) == pytest.approx(whole, rel=1e-9)
    # Archimedes: area below z is 2 pi r (r + z); the 64-gon loses 0.3 %.
    assert parts[0] == pytest.approx(2 * math.pi * 3.0 * 3.3, rel=5e-3)
    assert clip.points_mm[:, 2].max() <= 0.3 + 1e-8
    slope = np.array([1.0, 2.0, 3.0])
    assert clip.carry(points @ slope) == pytest.approx(clip.points_mm @ slope)
    assert clip.carry(points).shape == clip.points_mm.shape
    # Clipped faces keep their sense of rotation.
    assert mesh_volume(clip.points_mm, clip.faces) > 0.0
