"""The fast optics against slower ways to the same answer."""

from __future__ import annotations

import numpy as np
import pytest

from geometry.surface.surface import RayCaster
from sim.optics.camera.camera import refracted_rays
from sim.optics.field.bake import bake_light
from sim.optics.proof.checks import depth_error_mm
from sim.optics.proof.specimen import dent, finger
from sim.optics.raster.gbuffer import look, open_view
from workbench.core.design.camera import Camera
from workbench.core.design.lighting import LedRing, LightModel
from workbench.core.result.results import Skin


def section_tangent(skin: Skin, vertex: int, led_mm: np.ndarray) -> np.ndarray | None:
    """Direction at a vertex of the curve in which the plane of LED, vertex and normal cuts it.

    The published way, on the mesh: cut the triangles around the vertex by the plane; the cuts of
    the edges opposite to it, one on either side, give a central difference of the curve.
    """
    here = skin.points_mm[vertex]
    plane = np.cross(skin.normals[vertex], led_mm - here)
    plane /= np.linalg.norm(plane)
    ends = []
    for face in skin.faces[(skin.faces == vertex).any(axis=1)]:
        first, second = skin.points_mm[face[face != vertex]]
        high, low = (first - here) @ plane, (second - here) @ plane
        if high * low < 0.0:
            ends.append(first + high / (high - low) * (second - first))
    if len(ends) != 2:
        return None
    chord = ends[0] - ends[1]
    chord /= np.linalg.norm(chord)
    return chord if chord @ (led_mm - here) > 0.0 else -chord


def test_plane_target_is_the_tangent_of_the_section_curve() -> None:
    """Closed form and cut mesh agree within 1 degree median (findings of the prototype)."""
    mesh = finger(edge_mm=0.6)
    light = bake_light(mesh, LedRing(), model=LightModel.PLANE_TARGET)
    inner = np.flatnonzero(mesh.outer.points_mm[:, 2] > 1.0)
    errors = []
    for vertex in np.random.default_rng(7).choice(inner, 150, replace=False):
        for led in (0, 4):
            cut = section_tangent(mesh.outer, int(vertex), light.led_mm[led])
            if cut is not None:
                errors.append(np.degrees(np.arccos(min(1.0, cut @ light.direction[led, vertex]))))
    assert len(errors) > 200
    assert np.median(errors) < 1.0
    # A central difference over edges of 0.6 mm on a radius of 15 mm errs by up to 1.2 degrees.
    assert np.percentile(errors, 95) < 1.5


def test_depth_z_converges_to_cylinder_and_sphere() -> None:
    """Chords lie within the square of the edge: halving edges quarters the error of depth_z."""
    coarse, fine = (
        depth_error_mm(finger(edge_mm=edge_mm), radius_mm=15.0, cylinder_mm=27.0)
        for edge_mm in (1.0, 0.5)
    )
    assert fine < 0.01
    # Observed order 1.94; meshes of whole rings do not halve exactly.
    assert np.log2(coarse / fine) > 1.7


@pytest.mark.parametrize(
    ("at_mm", "depth_mm", "radius_mm"),
    [
        ((15.0, 0.0, 22.0), 1.2, 4.0),
        ((0.0, 0.0, 42.0), 6.0, 5.0),
        ((0.0, -15.0, 12.0), 11.0, 5.0),
        ((0.0, 15.0, 20.0), -6.0, 6.0),
    ],
    ids=["dent", "deep tip", "dent that hides skin", "skin pulled away"],
)
def test_casting_the_moved_patch_equals_casting_the_whole_skin(
    at_mm: tuple[float, float, float], depth_mm: float, radius_mm: float
) -> None:
    """Same triangle seen and same depth_z in every pixel, occlusion included."""
    skin = finger(edge_mm=0.8).outer
    camera = Camera(width_px=160, height_px=120)
    view = open_view(skin, camera, refracted_rays(camera, finger(edge_mm=0.8).cavity, 1.41))
    displacement = dent(skin, at_mm=at_mm, depth_mm=depth_mm, radius_mm=radius_mm)
    moved = look(view, displacement)
    whole = open_view(
        Skin(points_mm=moved.points_mm, faces=skin.faces, normals=moved.normals),
        camera,
        view.rays,
    ).background
    depth = np.full(160 * 120, np.nan)
    depth[view.background.pixel] = view.background.depth_z_mm
    depth[moved.pixels] = np.nan
    depth[moved.seen.pixel] = moved.seen.depth_z_mm
    exact = np.full(160 * 120, np.nan)
    exact[whole.pixel] = whole.depth_z_mm
    assert len(moved.pixels) > 100
    assert np.array_equal(np.isnan(depth), np.isnan(exact))
    # A ray that meets an edge may be given to either triangle, at the same depth in float32.
    np.testing.assert_allclose(depth, exact, atol=1e-4)


def test_hidden_skin_is_not_seen() -> None:
    """A dent 11 mm deep at -Y stands before the skin behind it: those pixels come nearer."""
    mesh = finger(edge_mm=0.8)
    camera = Camera(width_px=160, height_px=120)
    view = open_view(mesh.outer, camera, refracted_rays(camera, mesh.cavity, 1.0))
    displacement = dent(mesh.outer, at_mm=(0.0, -15.0, 12.0), depth_mm=11.0, radius_mm=5.0)
    moved = look(view, displacement)
    untouched = ~(np.abs(displacement) > 1e-3).any(axis=1)[mesh.outer.faces].any(axis=1)
    hidden = moved.seen.pixel[untouched[view.face[moved.seen.pixel]]]
    assert len(hidden) > 50
    before = dict(zip(view.background.pixel, view.background.depth_z_mm, strict=True))
    now = dict(zip(moved.seen.pixel, moved.seen.depth_z_mm, strict=True))
    assert all(now[pixel] < before[pixel] for pixel in hidden)


def test_normals_of_a_rigidly_turned_patch_turn_with_it() -> None:
    """Turning the whole skin by 10 degrees about Z turns every normal by 10 degrees."""
    mesh = finger(edge_mm=1.0)
    camera = Camera(width_px=32, height_px=24)
    view = open_view(mesh.outer, camera, refracted_rays(camera, mesh.cavity, 1.0))
    cosine, sine = np.cos(np.radians(10)), np.sin(np.radians(10))
    turn = np.array([[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]])
    moved = look(view, mesh.outer.points_mm @ turn.T - mesh.outer.points_mm)
    error = np.linalg.norm(moved.normals - mesh.outer.normals @ turn.T, axis=1)
    # Only the gap between given and area-weighted normals, largest on the rim, fails to turn;
    # the tip vertex does not move, and neither does its normal.
    assert error.max() < 0.02


def test_shadow_rays_agree_with_the_nearest_hit() -> None:
    """A point is occluded exactly when the first hit toward the light is nearer than the light."""
    mesh = finger(edge_mm=1.0)
    caster = RayCaster(mesh.outer.points_mm, mesh.outer.faces)
    random = np.random.default_rng(3)
    start = random.uniform([-25, -25, 1], [25, 25, 45], (500, 3))
    line = np.array([0.0, 0.0, 10.0]) - start
    distance = np.linalg.norm(line, axis=1)
    direction = line / distance[:, None]
    nearest = caster.hits(start, direction)[0]
    occluded = caster.occluded(start, direction, distance)
    assert np.array_equal(occluded, nearest < distance)
    assert 0.1 < occluded.mean() < 0.9
