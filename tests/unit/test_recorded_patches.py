"""Patches as a computation of fixed shapes says what they say step by step, on any device."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
import torch

from sim.forces.network.acceleration import Acceleration, Computation
from sim.forces.network.fixed_maps import Lattice, distinct, fixed_maps
from sim.forces.network.kernel_maps import Kernel, kernel_maps
from sim.forces.network.minkunet import arrays_of, new_network
from sim.forces.network.patches import PatchFinder, PatchPredictor
from sim.forces.network.recorded_patches import RecordedPatches, Rooms, within_reach
from sim.forces.network.spec import DEPTH, Target
from sim.forces.network.voxels import join, voxel_edge_mm, voxelise
from sim.forces.network.weights import NetworkWeights
from tests.unit.test_patches import PRESSES, SCALES, SPEC, given, weights
from workbench.core.base.errors import SolveError
from workbench.proof.benchmarks.forces import shell


def recorded(used: NetworkWeights, *, device: str = "cpu") -> PatchPredictor:
    """A predictor that computes as on a GPU."""
    found = PatchPredictor(used, PRESSES.skins[0].points_mm, faces=PRESSES.skins[0].faces)
    points_mm = found._finder.points_mm
    network = found._network.to(device)
    found._recorded = RecordedPatches(network, points_mm, found._viewing(), device=device)
    return found


@pytest.mark.parametrize("target", [Target.FORCE, Target.DISPLACEMENT, Target.STRESS])
def test_it_says_what_the_host_says(target: Target) -> None:
    """Step by step in NumPy and by blocks of pairs: the rounding of float32 is left."""
    spec = dataclasses.replace(SPEC, input_channels=6, output_channels=target.channels)
    used = weights(
        corrects=False,
        spec=spec,
        arrays=arrays_of(new_network(spec, seed=4)),
        target=target,
        output_scale=tuple(SCALES.output * (1 + k) for k in range(target.channels)),
    )
    fields = given([0, 1, 2, 5])
    expected = PatchPredictor(
        used, PRESSES.skins[0].points_mm, faces=PRESSES.skins[0].faces
    ).predict(fields)
    found = recorded(used).predict(fields)
    np.testing.assert_array_equal(found != 0.0, expected != 0.0)
    np.testing.assert_allclose(found, expected, atol=1e-5 * np.abs(expected).max())


def test_what_it_is_given_after_a_larger_patch_is_not_changed_by_it() -> None:
    """Rows that a smaller patch leaves free say nothing: room for all, then one by one."""
    fields = given([0, 1, 2, 3, 4, 5])
    found = recorded(weights())
    together = found.predict(fields)
    assert found._recorded is not None
    room = found._recorded._rooms
    alone = np.stack([found.predict(own) for own in fields])
    assert found._recorded._rooms == room
    np.testing.assert_allclose(alone, together, atol=1e-6 * np.abs(together).max())


def test_it_is_recorded_once_frames_find_room(monkeypatch: pytest.MonkeyPatch) -> None:
    """After four in a row; a larger patch is computed kernel by kernel again."""
    made: list[Acceleration] = []

    def counted(
        function: Computation, example: torch.Tensor, *, acceleration: Acceleration
    ) -> tuple[Computation, Acceleration, str]:
        made.append(acceleration)
        return function, acceleration, "a note"

    monkeypatch.setattr("sim.forces.network.recorded_patches.accelerated", counted)
    found, small = recorded(weights()), given([0])[0]
    large = np.ones_like(small)
    for _ in range(4):
        found.predict(small)
    assert not made and not found.notes
    found.predict(small)
    found.predict(small)
    assert made == [Acceleration.GRAPH] and found.notes == ("a note",)
    found.predict(large)
    assert len(made) == 1
    for _ in range(4):
        found.predict(small)
    assert len(made) == 2


def test_a_field_of_nothing_has_no_patch() -> None:
    """Before and after a patch: what does not correct says zero, what corrects what it was told."""
    found, nothing = recorded(weights()), np.zeros((400, 6), np.float32)
    assert not found.predict(nothing).any()
    found.predict(given([1]))
    assert not found.predict(nothing).any()


def test_a_field_that_is_not_finite_is_refused() -> None:
    """Weights so large that float32 ends."""
    used = weights()
    huge = {name: np.where(array > 0, 1e30, array) for name, array in used.arrays.items()}
    with pytest.raises(SolveError, match="not finite"):
        recorded(dataclasses.replace(used, arrays=huge)).predict(given([1]))


def test_fixed_maps_are_the_kernel_maps() -> None:
    """Two membranes, in tables with room to spare: rows in use are the same, holes told apart."""
    points_mm = shell(600)
    edge_mm = voxel_edge_mm(points_mm)
    voxels = join([voxelise(points_mm[:n], voxel_mm=edge_mm) for n in (600, 350)])
    expected = kernel_maps(voxels, kernel=Kernel.GATHER)
    size = voxels.coordinates[:, 1:].amax(0) + 1
    lattice = Lattice(size.tolist(), membranes=2, stem_edge=5, device="cpu")
    keys = lattice.keys(voxels.coordinates[:, 0], voxels.coordinates[:, 1:])
    # Every voxel twice, in any order, and rows that are none.
    given_keys = torch.cat([keys, keys.flip(0), keys.new_full((7,), lattice.free)])
    rooms = [count + 11 for count in expected.counts]
    found = distinct(given_keys, room=rooms[0], free=lattice.free)
    assert torch.equal(found.keys[: len(keys)], keys) and int(found.count) == len(keys)
    assert torch.equal(found.keys[found.of_row[: len(keys)]], keys)
    assert (found.rows.starts.diff() == (torch.arange(rooms[0]) < len(keys)) * 2).all()
    maps, counts = fixed_maps(found.keys, lattice, rooms=rooms[1:])
    assert [int(count) for count in counts] == list(expected.counts[1:])

    def same(table: torch.Tensor, plain: torch.Tensor, room: int, count: int) -> bool:
        used = table[: len(plain)]
        return torch.equal(torch.where(used == room, count, used), plain)

    tables = [(maps.stem, expected.stem), *zip(maps.levels, expected.levels, strict=True)]
    for (own, plain), level in zip(tables, [0, *range(DEPTH + 1)], strict=True):
        assert same(own.neighbours, plain.neighbours, rooms[level], expected.counts[level])
    for level, (own, plain) in enumerate(zip(maps.steps, expected.steps, strict=True)):
        count = expected.counts[level]
        assert same(own.children, plain.children, rooms[level], count)
        assert torch.equal(own.parent[:count], plain.parent)
        assert torch.equal(own.octant[:count], plain.octant)


def test_what_finds_no_room_is_counted() -> None:
    """Ten keys in a table of four: the first four stay, and ten are told."""
    found = distinct(torch.arange(10).flip(0), room=4, free=100)
    assert found.keys.tolist() == [0, 1, 2, 3] and int(found.count) == 10
    assert found.of_row.tolist() == [4] * 6 + [3, 2, 1, 0]
    small = Rooms(points=4, levels=(8,) * (DEPTH + 1))
    assert small.hold([4, *[8] * (DEPTH + 1)]) and not small.hold([10, *[8] * (DEPTH + 1)])
    grown = small.grown([10, *[1] * (DEPTH + 1)])
    assert grown.hold([12, *[8] * (DEPTH + 1)]) and grown.levels >= small.levels


def test_points_within_reach_are_those_of_all_distances(monkeypatch: pytest.MonkeyPatch) -> None:
    """In parts, which need not divide the points; each is within its own reach."""
    points_mm = shell(150).astype(np.float64)
    monkeypatch.setattr("sim.forces.network.recorded_patches.PAIRS_AT_ONCE", 150 * 40)
    table = within_reach(torch.from_numpy(points_mm), 6.0).numpy()
    apart = np.linalg.norm(points_mm[:, None] - points_mm, axis=2) < 6.0
    for row, near in zip(table, apart, strict=True):
        assert row[row < 150].tolist() == np.flatnonzero(near).tolist()
        assert (row[near.sum() :] == 150).all()


def test_the_patch_is_that_of_the_finder() -> None:
    """One that does not correct says something on the whole patch, and nothing elsewhere."""
    found = recorded(weights(corrects=False))
    finder = PatchFinder(PRESSES.skins[0].points_mm, reach_mm=found._finder.reach_mm)
    assert found._recorded is not None
    for own in given([0, 3]):
        patch, field = found._recorded.look(own)
        np.testing.assert_array_equal(patch, finder.patch(own[:, 3:]))
        assert field.shape == (len(patch), 3) and field.dtype == np.float32
