"""Triangles cut into patches: areas, sizes, and integrals of what is linear on them."""

from __future__ import annotations

import numpy as np

from geometry.surface.patches import cut
from geometry.surface.primitives import sphere
from geometry.surface.surface import face_areas, vertex_areas_mm2

POINTS, FACES = sphere(3.0)


def test_patches_are_small_and_have_the_area_of_their_triangles() -> None:
    """Of n^2 alike, each with a longest edge of at most what was asked for."""
    edge_mm = 0.1
    patches = cut(POINTS, FACES, edge_mm)
    areas_mm2 = face_areas(POINTS, FACES)
    assert np.allclose(np.bincount(patches.parent, patches.areas_mm2), areas_mm2, rtol=1e-12)
    corners = POINTS[FACES]
    longest_mm = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2).max(axis=1)
    pieces = np.bincount(patches.parent)
    assert (longest_mm / np.sqrt(pieces) <= edge_mm * (1.0 + 1e-9)).all()
    assert (longest_mm / (np.sqrt(pieces) - 1.0) > edge_mm).all()
    assert np.array_equal(patches.corners, FACES[patches.parent])
    assert np.allclose(patches.weights.sum(axis=1), 1.0) and (patches.weights > 0.0).all()


def test_a_linear_field_is_integrated_exactly() -> None:
    """Sum of value times area over patches = a third of each triangle's area to each corner."""
    values = np.random.default_rng(1).normal(size=(len(POINTS), 2))
    patches = cut(POINTS, FACES, 0.2)
    found = patches.areas_mm2 @ patches.at(values)
    assert np.allclose(found, vertex_areas_mm2(POINTS, FACES) @ values, rtol=1e-12)


def test_no_patch_lies_on_another() -> None:
    """The centroids of a triangle's pieces are as many places."""
    patches = cut(POINTS, FACES[:1], 0.05)
    places = patches.at(POINTS)
    assert len(np.unique(places.round(9), axis=0)) == len(places) > 16


def test_nothing_is_cut_into_nothing() -> None:
    """No triangle, no patch; one that is small enough stays whole."""
    assert not len(cut(POINTS, FACES[:0], 0.1).areas_mm2)
    assert len(cut(POINTS, FACES[:1], 100.0).areas_mm2) == 1
