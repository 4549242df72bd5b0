"""What a camera shows of a known displacement: depths of surfaces, whatever way their points went.

The skin is a ball of 15 mm radius: the true depth of any displaced place is known.
"""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.spatial import KDTree

from sim.reading.shown_press import PressCamera

RADIUS_MM = 15.0


@pytest.fixture(scope="module")
def camera() -> PressCamera:
    """A camera that has nothing but its skin: a cap of a ball, vertices .3 mm apart."""
    made = object.__new__(PressCamera)
    number = np.arange(12_000)
    z = 1.0 - 0.4 * (number + 0.5) / len(number)
    angle = number * np.pi * (3.0 - np.sqrt(5.0))
    ring = np.sqrt(1.0 - z**2)
    outward = np.column_stack([ring * np.cos(angle), ring * np.sin(angle), z])
    made.skin = SimpleNamespace(  # pyright: ignore[reportAttributeAccessIssue]
        points_mm=RADIUS_MM * outward, inward=-outward, count=len(number)
    )
    made._tree = KDTree(made.skin.points_mm)
    return made


def dent_mm(camera: PressCamera, peak_mm: float) -> np.ndarray:
    """Depth of a round dent at the pole, at the vertices, shape (V,)."""
    away_mm = np.linalg.norm(camera.skin.points_mm - [0, 0, RADIUS_MM], axis=1)
    return peak_mm * np.exp(-((away_mm / 2.5) ** 2))


def test_a_displacement_along_normals_is_its_own_depth(camera: PressCamera) -> None:
    """Both depths are h, to the curvature of the skin over its spacing."""
    wanted_mm = dent_mm(camera, 1.0)
    depth_mm, surface_mm = camera._depths(wanted_mm[:, None] * camera.skin.inward)
    # (.3 mm)^2 / (2 x 15 mm) is .003 mm; flanks turn the nearest vertex into another one.
    assert np.abs(depth_mm - wanted_mm).max() < 0.02
    assert np.abs(surface_mm - wanted_mm).max() < 0.02


def test_skin_that_slides_along_itself_has_no_depth(camera: PressCamera) -> None:
    """Turned by 2 degrees about an axis across: every point moves .5 mm, the surface does not."""
    angle = np.radians(2.0)
    turn = np.array(
        [[np.cos(angle), 0, np.sin(angle)], [0, 1, 0], [-np.sin(angle), 0, np.cos(angle)]]
    )
    moved_mm = camera.skin.points_mm @ turn.T - camera.skin.points_mm
    moved_mm[camera.skin.points_mm[:, 2] < 0.75 * RADIUS_MM] = 0.0
    assert np.linalg.norm(moved_mm, axis=1).max() > 0.4
    depth_mm, surface_mm = camera._depths(moved_mm)
    assert np.abs(depth_mm).max() < 0.01
    assert np.abs(surface_mm).max() < 0.01


def test_skin_at_rest_has_no_depth(camera: PressCamera) -> None:
    """Nor has skin that moved by less than counts."""
    depth_mm, surface_mm = camera._depths(np.full((camera.skin.count, 3), 1e-3))
    assert not depth_mm.any()
    assert not surface_mm.any()
