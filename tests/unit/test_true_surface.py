"""Known surfaces along a reader's normals: exact on a plane, whatever moves sideways."""

from __future__ import annotations

import numpy as np
import pytest

from sim.optics.maps.signal import tangents
from sim.optics.raster.gbuffer import sum_area_vectors
from sim.reading.rest_skin import RestSkin
from sim.reading.true_surface import KnownSkin, integrated_mm, surface_over

SIDE, STEP_MM = 41, 0.25
WIDTH_MM = 1.6


def plane(height_mm: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    """A square of triangles whose outside is +Z."""
    at = STEP_MM * (np.arange(SIDE) - SIDE // 2)
    x, y = np.meshgrid(at, at, indexing="ij")
    points = np.column_stack([x.ravel(), y.ravel(), np.full(x.size, height_mm)])
    corner = (SIDE * np.arange(SIDE - 1)[:, None] + np.arange(SIDE - 1)).ravel()
    one = np.column_stack([corner, corner + SIDE, corner + SIDE + 1])
    two = np.column_stack([corner, corner + SIDE + 1, corner + 1])
    return points, np.concatenate([one, two])


def rest_skin() -> RestSkin:
    points, faces = plane()
    inward = np.tile([0.0, 0.0, -1.0], (len(points), 1))
    one, two = tangents(inward)
    area = sum_area_vectors(points, faces, len(points))
    return RestSkin(
        points_mm=points,
        faces=faces,
        inward=inward,
        one=one,
        two=two,
        area_mm2=-area,
        side=np.full(len(points), -1.0),
    )


def dent_mm(points: np.ndarray, depth_mm: float = 0.8) -> np.ndarray:
    """A smooth dent: a sharp foot would be cut off by edges that cross it."""
    across = np.linalg.norm(points[:, :2], axis=1)
    return depth_mm * np.exp(-((across / WIDTH_MM) ** 2))


def test_a_skin_that_stands_higher_and_moves_sideways_reads_its_depth() -> None:
    """Exact: a rigid shift along the plane, and a rest .12 mm higher, change no depth."""
    skin = rest_skin()
    points, faces = plane(0.12)
    moved = points.copy()
    moved[:, 2] -= 0.4
    moved[:, :2] += 0.07
    found = surface_over(skin, KnownSkin(rest_mm=points, displaced_mm=moved, faces=faces))
    inside = np.abs(skin.points_mm[:, :2]).max(axis=1) < 4.0
    assert found.depth_mm[inside] == pytest.approx(0.4, abs=1e-5)
    assert found.inward[inside] == pytest.approx(skin.inward[inside], abs=1e-6)


def test_lines_that_miss_are_not_zero() -> None:
    """NaN beyond the known skin, so that nobody counts it as read rightly."""
    skin = rest_skin()
    points, faces = plane()
    half = faces[points[faces][:, :, 0].max(axis=1) <= 0.0]
    found = surface_over(skin, KnownSkin(rest_mm=points, displaced_mm=points, faces=half))
    assert np.isnan(found.depth_mm[skin.points_mm[:, 0] > 0.1]).all()
    assert np.isfinite(found.depth_mm[skin.points_mm[:, 0] < -0.1]).all()


def test_known_normals_integrate_to_the_dent() -> None:
    """To .01 mm of a dent of .8: mean normals of edges are good to their length squared."""
    skin = rest_skin()
    points, faces = plane()
    moved = points.copy()
    depth_mm = dent_mm(points)
    moved[:, 2] -= depth_mm
    surface = surface_over(skin, KnownSkin(rest_mm=points, displaced_mm=moved, faces=faces))
    assert surface.depth_mm == pytest.approx(depth_mm, abs=1e-5)
    free = depth_mm > 1e-3
    found = integrated_mm(skin, surface, free)
    assert np.abs(found - depth_mm)[free].mean() < 0.01
    assert found[~free].any() == np.False_
    # The null of this test: normals at rest give no depth at all.
    rest = surface_over(skin, KnownSkin(rest_mm=points, displaced_mm=points, faces=faces))
    assert np.abs(integrated_mm(skin, rest, free)).max() < 1e-5
