"""A target typed on a long face of any preset is where the press goes, drawn and solved."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from geometry.surface.surface import closest_point, face_areas
from workbench.core.design.design import SensorDesign
from workbench.project.aim import sensing_skin, skin_place
from workbench.project.named_designs import load_design, presets
from workbench.view.scene_shapes import outer_faces

KEPT_MM = 0.1
LARGEST = 40
"""Faces of a body that are looked at, the largest first."""


@pytest.mark.slow
@pytest.mark.parametrize("name", presets())
def test_the_middle_of_a_long_face_keeps_its_target(
    name: str, made: Callable[[SensorDesign, str], Any]
) -> None:
    """The distance from target to press is 0 mm on the drawn skin, and the meshes' own on the
    solver's: below 0.1 mm. The nearest corner is millimetres away."""
    design = load_design(name)
    solid, mesh = made(design, "build"), made(design, "mesh")
    points, faces = outer_faces(solid.membrane)
    edges = points[faces] - np.roll(points[faces], 1, axis=1)
    long = np.argsort(-np.linalg.norm(edges, axis=2).max(axis=1))[:LARGEST]
    large = np.argsort(-face_areas(points, faces))[:LARGEST]
    # Slivers beside a crease are long but no face: the solver's mesh blunts the crease.
    chosen = np.union1d(large, long[face_areas(points, faces)[long] > 0.2])
    middles = points[faces[chosen]].mean(axis=1)
    corner_mm = np.linalg.norm(points[faces[chosen]] - middles[:, None], axis=2).min(axis=1)
    assert corner_mm.max() > 0.5
    for middle in middles:
        place = skin_place(sensing_skin(solid), (middle[0], middle[1], middle[2]))
        assert place.point_mm == pytest.approx(middle, abs=1e-6)
    _, away_mm, _ = closest_point(mesh.outer.points_mm, mesh.outer.faces, middles)
    assert away_mm.max() < KEPT_MM
