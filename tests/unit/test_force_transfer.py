"""Forces carried from one skin to another keep their sum; values keep linear fields."""

from __future__ import annotations

import numpy as np
import pytest

from sim.forces.transfer import barycentric, shares_on
from workbench.core.result.results import Skin


def patch(count: int) -> Skin:
    """The unit square at z = 0 in triangles of one `count`-th."""
    side = np.linspace(0.0, 1.0, count + 1)
    x, y = np.meshgrid(side, side, indexing="ij")
    number = np.arange((count + 1) ** 2).reshape(count + 1, count + 1)
    a, b = number[:-1, :-1].ravel(), number[1:, :-1].ravel()
    c, d = number[1:, 1:].ravel(), number[:-1, 1:].ravel()
    faces = np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)]).astype(np.int32)
    points = np.stack([x.ravel(), y.ravel(), np.zeros(x.size)], axis=1)
    return Skin(points_mm=points, faces=faces, normals=np.tile([0.0, 0.0, 1.0], (x.size, 1)))


COARSE, FINE = patch(3), patch(7)


def test_a_linear_field_is_carried_exactly() -> None:
    """u = (x, 2 y, x - y) at the vertices of the one is so at those of the other."""

    def field(points: np.ndarray) -> np.ndarray:
        x, y = points[:, 0], points[:, 1]
        return np.stack([x, 2.0 * y, x - y], axis=1)[None]

    found = shares_on(COARSE, FINE.points_mm).interpolate(field(COARSE.points_mm))
    assert np.allclose(found, field(FINE.points_mm), atol=1e-12)


def test_forces_keep_their_sum_and_their_moment() -> None:
    """Shares of a force at a point of a triangle act, together, where the force did."""
    rng = np.random.default_rng(1)
    forces = rng.normal(size=(2, len(FINE.points_mm), 3))
    spread = shares_on(COARSE, FINE.points_mm).spread(forces, len(COARSE.points_mm))
    assert np.allclose(spread.sum(axis=1), forces.sum(axis=1), atol=1e-5)
    before = np.cross(FINE.points_mm, forces).sum(axis=1)
    after = np.cross(COARSE.points_mm, spread).sum(axis=1)
    assert np.allclose(after, before, atol=1e-5)


def test_flags_are_those_of_the_nearest_vertex() -> None:
    """A flag is not shared out."""
    flags = COARSE.points_mm[None, :, 0] > 0.5
    found = shares_on(COARSE, FINE.points_mm).nearest(flags)
    assert found.dtype == bool
    assert (found[0] == (FINE.points_mm[:, 0] > 0.5)).mean() > 0.95


@pytest.mark.parametrize("share", [(1.0, 0.0, 0.0), (0.2, 0.3, 0.5), (0.0, 0.5, 0.5)])
def test_barycentric_coordinates_are_those_the_point_was_made_of(
    share: tuple[float, float, float],
) -> None:
    """Corner, inside and edge of a triangle in space."""
    corners = np.array([[[0.0, 0.0, 0.0], [2.0, 0.1, 0.3], [0.4, 1.5, -0.2]]])
    point = np.einsum("c,ncx->nx", share, corners)
    assert np.allclose(barycentric(corners, point)[0], share, atol=1e-12)
