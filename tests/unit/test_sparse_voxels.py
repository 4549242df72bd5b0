"""Points to voxels and back, in closed form."""

from __future__ import annotations

import numpy as np
import pytest
import torch

from sim.forces.network.segments import segment_sum, segments
from sim.forces.network.voxels import join, spacing_mm, voxel_edge_mm, voxelise
from workbench.core.base.errors import DesignError


def test_points_of_a_voxel_are_averaged_and_each_gets_the_mean_back() -> None:
    """Three points in a voxel with 1, 2, 6 and one alone with 10: means 3 and 10."""
    points_mm = np.array([[0.0, 0, 0], [5.0, 0, 0], [0.1, 0.1, 0], [0.2, 0, 0.2]])
    voxels = voxelise(points_mm, voxel_mm=1.0)
    features = torch.tensor([1.0, 10.0, 2.0, 6.0]).view(4, 1, 1)
    mean = voxels.mean(features)
    assert voxels.coordinates.tolist() == [[0, 0, 0, 0], [0, 5, 0, 0]]
    assert mean.flatten().tolist() == [3.0, 10.0]
    assert voxels.to_points(mean).flatten().tolist() == [3.0, 10.0, 3.0, 3.0]


def test_gradient_of_a_voxel_is_the_sum_over_its_points() -> None:
    """d(sum of a_p y_v(p)) / dy_v = sum of a_p over the points of v; also for two samples."""
    random = np.random.default_rng(0)
    voxels = voxelise(random.uniform(0, 3, (40, 3)), voxel_mm=1.0)
    values = torch.randn(voxels.count, 2, 3, dtype=torch.float64, requires_grad=True)
    factors = torch.randn(40, 2, 3, dtype=torch.float64)
    (voxels.to_points(values) * factors).sum().backward()
    expected = np.zeros((voxels.count, 2, 3))
    np.add.at(expected, voxels.voxel_of_point.numpy(), factors.numpy())
    assert values.grad is not None
    # Sums of some ten numbers of size 1, in another order.
    np.testing.assert_allclose(values.grad.numpy(), expected, atol=1e-14)
    assert torch.autograd.gradcheck(voxels.to_points, (values,))


def test_a_moved_membrane_keeps_its_voxels() -> None:
    """Translation by any amount changes no voxel, for points away from voxel borders."""
    cells = np.random.default_rng(1).integers(0, 9, (60, 3))
    points_mm = cells * 0.5 + 0.01 * np.random.default_rng(2).uniform(size=(60, 3))
    moved = voxelise(points_mm + np.array([-7.3, 0.21, 113.9]), voxel_mm=0.5)
    there = voxelise(points_mm, voxel_mm=0.5)
    assert torch.equal(there.coordinates, moved.coordinates)
    assert torch.equal(there.voxel_of_point, moved.voxel_of_point)


def test_a_flat_face_with_rounding_stays_one_layer() -> None:
    """A pad whose points differ by 1e-6 mm in height has one layer of voxels."""
    random = np.random.default_rng(3)
    points_mm = np.concatenate(
        [random.uniform(0, 10, (200, 2)), 4.0 + random.uniform(-1e-6, 1e-6, (200, 1))], axis=1
    )
    assert set(voxelise(points_mm, voxel_mm=0.5).coordinates[:, 3].tolist()) == {0}


def test_spacing_of_a_square_grid_is_its_edge() -> None:
    """By area and by nearest neighbour, within what the border of 30 x 30 cells makes: 4 %."""
    across, down = np.meshgrid(np.arange(31), np.arange(31), indexing="ij")
    points_mm = 0.8 * np.stack([across, down, 0 * across], axis=-1).reshape(-1, 3)
    corner = (np.arange(30)[:, None] * 31 + np.arange(30)).ravel()
    faces = np.concatenate(
        [
            np.stack([corner, corner + 31, corner + 32], axis=1),
            np.stack([corner, corner + 32, corner + 1], axis=1),
        ]
    )
    assert spacing_mm(points_mm) == pytest.approx(0.8, rel=1e-9)
    assert spacing_mm(points_mm, faces) == pytest.approx(0.8 * 30 / 31, rel=1e-9)
    assert voxel_edge_mm(points_mm) == pytest.approx(0.6, rel=1e-9)


def test_voxels_keep_nearly_all_points_apart_and_join_them_with_neighbours() -> None:
    """On a finger's skin: 99 % of the points alone, and 4 to 9 neighbours at the finest level."""
    from sim.forces.network.levels import neighbours
    from workbench.proof.benchmarks.forces import shell

    points_mm = shell(3000)
    voxels = voxelise(points_mm, voxel_mm=voxel_edge_mm(points_mm))
    table = neighbours(voxels.coordinates, 3)
    assert voxels.count > 0.99 * len(points_mm)
    assert 4.0 < float((table < voxels.count).sum()) / voxels.count < 9.0


def test_joined_membranes_keep_their_points() -> None:
    """The second membrane's voxels and points follow the first's."""
    one = voxelise(np.array([[0.0, 0, 0], [3.0, 0, 0]]), voxel_mm=1.0)
    two = voxelise(np.array([[0.0, 0, 0], [0.1, 0, 0], [0, 0, 2.0]]), voxel_mm=1.0)
    both = join([one, two, one])
    assert both.coordinates[:, 0].tolist() == [0, 0, 1, 1, 2, 2]
    assert both.voxel_of_point.tolist() == [0, 1, 2, 2, 3, 4, 5]
    features = torch.arange(7.0).view(7, 1, 1)
    assert both.mean(features).flatten().tolist() == [0.0, 1.0, 2.5, 4.0, 5.0, 6.0]


def test_segment_sums_equal_a_loop_and_an_empty_group_is_zero() -> None:
    """The twin adds row after row."""
    group = torch.tensor([3, 0, 3, 1, 3])
    rows = torch.randn(5, 4, dtype=torch.float64)
    expected = torch.zeros(5, 4, dtype=torch.float64)
    for row, place in zip(rows, group.tolist(), strict=True):
        expected[place] += row
    sums = segment_sum(rows, segments(group, count=5))
    # The same three numbers in the same order.
    assert torch.equal(sums, expected)


@pytest.mark.parametrize(
    ("points_mm", "voxel_mm", "at"),
    [
        (np.zeros((0, 3)), 1.0, "points_mm"),
        (np.array([[0.0, np.nan, 0.0]]), 1.0, "points_mm"),
        (np.array([[0.0, 0, 0], [1e3, 0, 0]]), 1e-4, "voxel_mm"),
        (np.array([[0.0, 0, 0], [1.0, 0, 0]]), 0.0, "voxel_mm"),
    ],
)
def test_bad_clouds_are_refused(points_mm: np.ndarray, voxel_mm: float, at: str) -> None:
    """No point, a NaN, a voxel a millionth of the membrane, a voxel of no size."""
    with pytest.raises(DesignError) as caught:
        voxelise(points_mm, voxel_mm=voxel_mm)
    assert caught.value.at == at
    assert caught.value.hint
