"""Small steps of reading a damaged body, each against what can be counted."""

from __future__ import annotations

import numpy as np

from geometry.intake.mending import MERGE_SHARE, _merged


def test_near_vertices_of_an_open_mesh_become_one() -> None:
    """A square of two triangles whose shared edge is there twice, a hair apart: four vertices."""
    reach = MERGE_SHARE * 2.0
    points = np.array(
        [[0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 0, 0], [2, 2, 0], [0, 2, 0]], dtype=np.float64
    )
    points[3:5, 0] += 0.1 * reach
    faces, notes = np.array([[0, 1, 2], [3, 4, 5]]), []
    merged, left = _merged(points, faces, notes)
    assert merged.shape == (4, 3)
    np.testing.assert_allclose(merged[left], points[faces], atol=reach)
    assert len(np.unique(left)) == 4
    assert notes == ["2 vertices were merged with a neighbour"]


def test_a_triangle_that_loses_a_corner_goes() -> None:
    """A sliver whose two corners become one is no triangle any more; a doubled one goes too."""
    points = np.array([[0, 0, 0], [2, 0, 0], [0, 2, 0], [2, 1e-12, 0]], dtype=np.float64)
    faces, notes = np.array([[0, 1, 2], [1, 3, 2], [2, 0, 1]]), []
    merged, left = _merged(points, faces, notes)
    assert len(merged) == 3 and len(left) == 1
    assert "1 doubled triangles were removed" in notes
