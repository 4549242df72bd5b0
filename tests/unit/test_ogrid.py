"""Rays of an O-grid on a half ball: how many, and how far apart their points are."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh

from geometry.volume.curved import CurvedSurface
from geometry.volume.ogrid import FEWEST, Pace, axis_of, on_base, ray_grid

RADIUS_MM = 10.0


@pytest.fixture(scope="module")
def dome() -> trimesh.Trimesh:
    """Half a ball on z = 0, fine enough to be round."""
    ball = trimesh.creation.icosphere(subdivisions=5, radius=RADIUS_MM)
    return ball.slice_plane([0.0, 0.0, 0.0], [0.0, 0.0, 1.0])


@pytest.mark.parametrize(
    ("spacing_mm", "count", "rows"), [(0.5, 31, 18), (1.0, 16, 9), (2.0, 8, 4), (30.0, FEWEST, 2)]
)
def test_cells_are_as_wide_as_asked(
    dome: trimesh.Trimesh, spacing_mm: float, count: int, rows: int
) -> None:
    """n x n cells on top and rows of 4 n beside them, down to the fewest.

    The grid's cap ends 3 mm high, so 62.1 mm around at half of that are divided by 4 n, and 8.8 mm
    from the patch's rim, a mean 6.9 mm from the apex, to the base (15.7 mm) by the rows.
    """
    points = np.array(dome.vertices)
    grid = ray_grid(CurvedSurface(points, np.array(dome.faces)), axis_of(points), Pace(spacing_mm))
    assert len(grid.ring) == 4 * count
    assert len(grid.quads) == count**2 + 4 * count * rows
    assert grid.quads.max() == len(grid.origins) - 1


def test_the_ring_stands_on_the_base(dome: trimesh.Trimesh) -> None:
    """Its points are put on z = 0, all others stay above."""
    points = np.array(dome.vertices)
    surface = CurvedSurface(points, np.array(dome.faces))
    grid = ray_grid(surface, axis_of(points), Pace(2.0))
    found = on_base(surface.points(grid.origins, grid.directions), grid)
    assert not found[grid.ring, 2].any()
    others = np.setdiff1d(np.arange(len(found)), grid.ring)
    assert found[others, 2].min() > 0.5
