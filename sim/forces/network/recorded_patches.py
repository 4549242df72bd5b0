"""Patches of a skin, found and looked at on a GPU: from what enters to the field, in one launch.

What `patches` does step by step on the host, as one computation of fixed shapes: the points within
reach of the field, their voxels from each side, the kernel maps (`fixed_maps`), the network, the
mean of the looks. Tables have some room to spare. Once several frames in a row found room, the
computation is recorded as a CUDA graph, and a frame takes one launch and two copies; a patch that
finds no room has larger tables made, and is computed kernel by kernel like those after it, until
they settle again: recording takes as long as some frames, which a short press would not earn back.

Which points are near which is found once for a skin: K numbers for each of V points, all pairs
measured. Places are float64, as on the host, so the voxels are the same; fields differ by the
rounding of float32.

Measured on an H200, a dent of 223 of 25,000 points, the small network: 500 fields a second, 63 when
the host found patch, voxels and maps step by step. A press of ten frames whose patch grows, with
all that is prepared for it, takes 0.20 s in place of 0.27.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import torch
from torch import Tensor

from sim.forces.network.acceleration import Acceleration, Computation, accelerated
from sim.forces.network.fixed_maps import Distinct, Lattice, distinct, fixed_maps
from sim.forces.network.kernel_maps import KernelMaps, padded
from sim.forces.network.minkunet import MinkUNet
from sim.forces.network.segments import segment_sum
from sim.forces.network.spec import DEPTH, Target
from sim.forces.network.turns import value_matrix

PAIRS_AT_ONCE = 1 << 23
"""Distances that are measured at a time when a skin is prepared."""
FRAMES_BEFORE = 4
"""Frames that must find room in the same tables before the computation is recorded."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Viewing:
    """How a network looks at a skin."""

    leading: slice
    """Channels, of those that enter, that a patch is laid around."""
    faint: float
    """Share of their largest value below which a point bears none."""
    reach_mm: float
    """Farthest distance of a patch's point from one that bears."""
    voxel_mm: float
    matrices: Sequence[np.ndarray]
    """Turn of each look, (3, 3); look l of L moves points by l / L of a voxel."""
    target: Target
    input_scale: Sequence[float]
    output_scale: Sequence[float]


@dataclass(frozen=True, kw_only=True, slots=True)
class Rooms:
    """Rows of the tables."""

    points: int
    """Of a patch."""
    levels: tuple[int, ...]
    """Voxels of all looks at each level, finest first."""

    def hold(self, counts: Sequence[int]) -> bool:
        """Whether so many points, and voxels of each level, find room."""
        return all(count <= room for count, room in zip(counts, self._all(), strict=True))

    def grown(self, counts: Sequence[int]) -> Rooms:
        """At least as large, and with a quarter more room than these need."""
        points, *levels = (
            max(room, padded(count + count // 4 + 1))
            for count, room in zip(counts, self._all(), strict=True)
        )
        return Rooms(points=points, levels=tuple(levels))

    def _all(self) -> tuple[int, ...]:
        return (self.points, *self.levels)


@dataclass(frozen=True, kw_only=True, slots=True)
class _Laid:
    """A patch, and its voxels from all sides."""

    point: Tensor
    """Numbers of the points in rising order, V for a free row, shape (P,)."""
    voxels: Distinct
    """Of the points of all looks, shape (L P,)."""
    maps: KernelMaps
    counts: Tensor
    """Points and voxels of each level, room or not, shape (2 + DEPTH,)."""


class RecordedPatches:
    """A network that looks at patches of one skin, all on a device.

    Attributes:
        note: What the user should know about how it runs; empty when all is well.
    """

    def __init__(
        self, network: MinkUNet, points_mm: np.ndarray, viewing: Viewing, *, device: str
    ) -> None:
        """Prepare a skin.

        Args:
            network: Folded, on the device.
            points_mm: Points at rest [mm], shape (V, 3), float64.
            viewing: How the network looks at them.
            device: Where all is computed.
        """
        self.note = ""
        self._network, self._viewing, self._device = network, viewing, device
        looks = len(viewing.matrices)
        turned_mm = np.stack([points_mm @ matrix.T for matrix in viewing.matrices])
        # Half a voxel, and less than one by the shift.
        size = np.floor(np.ptp(turned_mm, axis=1).max(axis=0) / viewing.voxel_mm + 1.5) + 1
        self._lattice = Lattice(
            size.astype(int).tolist(),
            membranes=looks,
            stem_edge=network.spec.stem_edge,
            device=device,
        )
        beyond = np.full((looks, 1, 3), np.inf)
        self._turned_mm = self._there(np.concatenate([turned_mm, beyond], axis=1))
        self._turns = self._there(np.stack(viewing.matrices))
        back = [value_matrix(matrix.T, viewing.target) for matrix in viewing.matrices]
        self._back = self._there(np.stack(back) / looks)
        self._shift = self._there(np.arange(looks)[:, None, None] / looks)
        self._look = torch.arange(looks, device=device)[:, None]
        self._input_scale = self._there(np.array(viewing.input_scale, np.float32))
        self._output_scale = self._there(np.array(viewing.output_scale, np.float32))
        self._near = within_reach(self._there(points_mm), viewing.reach_mm)
        self._rooms = Rooms(points=0, levels=(0,) * (DEPTH + 1))
        self._run: Computation | None = None
        self._settled = 0

    def look(self, given: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The patch of one sample and the mean of the looks at it.

        Args:
            given: What enters at the points, shape (V, I).

        Returns:
            Numbers of the points in rising order, (P,), and the field there, (P, C), float32.
        """
        there = self._there(given.astype(np.float32, copy=False))
        with torch.no_grad():
            found = self._computed(there)
        count, room = self._counts(found)[0], self._rooms.points
        channels = self._viewing.target.channels
        field = found[: room * channels].reshape(room, channels)[:count]
        point = found[room * channels : room * channels + count]
        return point.astype(np.int64), field.astype(np.float32)

    def _there(self, array: np.ndarray) -> Tensor:
        return torch.from_numpy(np.ascontiguousarray(array)).to(self._device)

    @staticmethod
    def _counts(found: np.ndarray) -> list[int]:
        """How many points and voxels of each level a result says there are."""
        return found[-(2 + DEPTH) :].astype(np.int64).tolist()

    def _computed(self, given: Tensor) -> np.ndarray:
        """What `_on_device` gives, once all finds room."""
        while True:
            if self._rooms.points:
                found = self._computation(given)(given).cpu().numpy()
                if self._rooms.hold(self._counts(found)):
                    return found
            self._make_room(given)

    def _computation(self, given: Tensor) -> Computation:
        """Recorded where that is worth it."""
        if self._run is None and self._settled >= FRAMES_BEFORE:
            self._run, _, self.note = accelerated(
                self._on_device, given, acceleration=Acceleration.GRAPH
            )
        self._settled += 1
        return self._run or self._on_device

    def _make_room(self, given: Tensor) -> None:
        """For what enters, and for somewhat more."""
        # The memory of what was recorded is given back before more is taken.
        self._run, self._settled = None, 0
        points = max(int(self._bearing(given).sum()), 1)
        most = Rooms(points=points, levels=(len(self._look) * points,) * (DEPTH + 1))
        self._rooms = self._rooms.grown(self._laid(given, most).counts.tolist())

    def _bearing(self, given: Tensor) -> Tensor:
        """Whether each point is within reach of one that bears a value, shape (V,)."""
        size = given[:, self._viewing.leading].abs().amax(1)
        bears = size > self._viewing.faint * size.max()
        beyond = bears.new_zeros(1)
        near = torch.cat([bears, beyond]).index_select(0, self._near.view(-1))
        return near.view(self._near.shape).any(1)

    def _laid(self, given: Tensor, rooms: Rooms) -> _Laid:
        """A patch laid around what bears, in tables of so many rows."""
        near, count = self._bearing(given), len(given)
        place = torch.where(near, near.cumsum(0) - 1, rooms.points).clamp(max=rooms.points)
        numbers = torch.arange(count, device=near.device)
        # What bears nothing, or found no room, goes to a row behind the table, which is cut off.
        point = place.new_full((rooms.points + 1,), count).scatter_(0, place, numbers)[:-1]
        turned_mm = self._turned_mm[:, point]
        from_low = (turned_mm - turned_mm.amin(1, keepdim=True)) / self._viewing.voxel_mm
        there = (point < count).expand(len(self._look), -1)
        cells = torch.floor(from_low + 0.5 + self._shift)
        cells = torch.where(there[..., None], cells, 0.0).long()
        free = self._lattice.free
        keys = torch.where(there, self._lattice.keys(self._look, cells), free)
        voxels = distinct(keys.flatten(), room=rooms.levels[0], free=free)
        maps, coarser = fixed_maps(voxels.keys, self._lattice, rooms=rooms.levels[1:])
        counts = torch.stack([near.sum(), voxels.count, *coarser])
        return _Laid(point=point, voxels=voxels, maps=maps, counts=counts)

    def _on_device(self, given: Tensor) -> Tensor:
        """Field at the rows of the patch, their points, and all counts, in a row, float64."""
        laid, looks = self._laid(given, self._rooms), len(self._look)
        scaled = torch.cat([given / self._input_scale, given.new_zeros(1, given.shape[1])])
        vectors = scaled[laid.point].view(len(laid.point), -1, 3).double()
        features = torch.einsum("lij,pkj->lpki", self._turns, vectors).float()
        sums = segment_sum(features.reshape(looks * len(laid.point), -1), laid.voxels.rows)
        # A free row has no points: 0 over 1.
        sizes = laid.voxels.rows.starts.diff().clamp(min=1)
        values = self._network((sums / sizes[:, None])[:, None], laid.maps)[:, 0]
        own = laid.voxels.of_row.clamp(max=len(values) - 1)
        seen = (values.index_select(0, own) * self._output_scale).double()
        seen = seen.view(looks, len(laid.point), -1)
        field = torch.einsum("lij,lpj->pi", self._back, seen)
        return torch.cat([field.flatten(), laid.point.double(), laid.counts.double()])


def within_reach(points_mm: Tensor, reach_mm: float) -> Tensor:
    """Points nearer to each point than a distance, itself included, shape (V, K), int32.

    Args:
        points_mm: Shape (V, 3).
        reach_mm: The distance; K is the most points that are nearer to any.

    Returns:
        Rows in rising order, filled up with V.
    """
    count = len(points_mm)
    rows, columns = [], []
    step = max(1, PAIRS_AT_ONCE // count)
    for first in range(0, count, step):
        here = points_mm[first : first + step]
        x, y, z = (here[:, axis, None] - points_mm[:, axis] for axis in range(3))
        near = x.square_() + y.square_() + z.square_() < reach_mm**2
        row, column = near.nonzero(as_tuple=True)
        rows.append(row + first)
        columns.append(column)
    row, column = torch.cat(rows), torch.cat(columns)
    lengths = torch.bincount(row, minlength=count)
    starts = lengths.cumsum(0) - lengths
    table = column.new_full((count, int(lengths.max())), count, dtype=torch.int32)
    table[row, torch.arange(len(row), device=row.device) - starts[row]] = column.int()
    return table
