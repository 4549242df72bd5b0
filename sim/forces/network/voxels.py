"""Points to voxels and back: a voxel takes the mean of its points and gives each its value.

A point at p falls into voxel floor((p - low) / edge + 1/2 + shift), where `low` is the lower corner
of the cloud and the shift zero unless it is asked for: a membrane that is moved keeps its voxels,
and a flat face of it lies in the middle of a layer of voxels, not on the border of two, where
rounding would decide.

Left out: nothing is interpolated between voxels. The points are those of the membrane at rest, so
what a frame changes is features alone and the voxels of a whole skin are found once.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import torch
from torch import Tensor

from sim.forces.network.segments import Segments, segment_sum, segments
from workbench.core.base.check import expect
from workbench.core.base.errors import DesignError

VOXEL_PER_SPACING = 0.75
"""Voxel edge over the spacing of the points. The published 0.11 mm for points 0.9 mm apart leaves
1.0 of 27 neighbours at the two finest levels, which makes the network a function of single points;
a voxel as large as the spacing merges many points. At 0.75, 99 % of the points keep a voxel of
their own and the levels have 6, 11 and 13 neighbours."""
MOST_VOXELS_ALONG = 100_000
"""Along an axis; the product of three such extents and some membranes stays below 2^63."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Voxels:
    """The occupied voxels of one membrane, or of several that are computed together."""

    coordinates: Tensor
    """Membrane, x, y, z of each voxel, shape (N, 4), int64, unique, in lexicographic order."""
    voxel_of_point: Tensor
    """Voxel of each point, shape (P,), int64."""
    points: Segments
    """The points of each voxel."""

    @property
    def count(self) -> int:
        """Occupied voxels, N."""
        return self.coordinates.shape[0]

    def to(self, device: str | torch.device) -> Voxels:
        """The same on another device."""
        return Voxels(
            coordinates=self.coordinates.to(device),
            voxel_of_point=self.voxel_of_point.to(device),
            points=self.points.to(device),
        )

    def mean(self, features: Tensor) -> Tensor:
        """Mean over the points of each voxel, shape (N, B, C) from (P, B, C)."""
        sums = segment_sum(features.flatten(1), self.points)
        sizes = self.points.starts.diff().to(sums.dtype)
        return (sums / sizes[:, None]).view(self.count, *features.shape[1:])

    def to_points(self, values: Tensor) -> Tensor:
        """Each point's value of its voxel, shape (P, B, C) from (N, B, C); differentiable."""
        if not torch.is_grad_enabled():
            return values.index_select(0, self.voxel_of_point)
        return _ToPoints.apply(values, self.voxel_of_point, self.points)


class _ToPoints(torch.autograd.Function):
    """A gather whose gradient is summed in a fixed order."""

    @staticmethod
    def forward(ctx: Any, values: Tensor, voxel_of_point: Tensor, points: Segments) -> Tensor:
        ctx.points = points
        return values.index_select(0, voxel_of_point)

    @staticmethod
    def backward(ctx: Any, *gradients: Tensor) -> tuple[Tensor, None, None]:
        (gradient,) = gradients
        sums = segment_sum(gradient.flatten(1).contiguous(), ctx.points)
        return sums.view(-1, *gradient.shape[1:]), None, None


def voxelise(points_mm: np.ndarray, *, voxel_mm: float, shift: np.ndarray | float = 0.0) -> Voxels:
    """The occupied voxels of one membrane.

    Args:
        points_mm: Points of the membrane at rest [mm], shape (P, 3).
        voxel_mm: Edge of a voxel.
        shift: Share of a voxel, in [0, 1), by which the points are moved among the voxels.

    Raises:
        DesignError: If there is no point, one is not finite, or the voxel is far too small.
    """
    expect(points_mm, "P 3", name="points_mm")
    if len(points_mm) == 0 or not np.isfinite(points_mm).all():
        raise DesignError(
            f"of {len(points_mm)} points of the skin not all are finite, or there is none",
            hint="mesh the membrane again",
            at="points_mm",
        )
    low = points_mm.min(axis=0)
    most = float(np.ptp(points_mm, axis=0).max()) / voxel_mm if voxel_mm > 0.0 else np.inf
    if most > MOST_VOXELS_ALONG:
        raise DesignError(
            f"a voxel of {voxel_mm:.3g} mm is too small for this membrane",
            hint=f"use {VOXEL_PER_SPACING} times the spacing of the points",
            at="voxel_mm",
        )
    cells = np.floor((points_mm - low) / voxel_mm + 0.5 + shift).astype(np.int64)
    unique, voxel_of_point = np.unique(cells, axis=0, return_inverse=True)
    numbered = np.concatenate([np.zeros((len(unique), 1), dtype=np.int64), unique], axis=1)
    group = torch.from_numpy(voxel_of_point.reshape(-1))
    return Voxels(
        coordinates=torch.from_numpy(numbered),
        voxel_of_point=group,
        points=segments(group, count=len(unique)),
    )


def join(membranes: Sequence[Voxels]) -> Voxels:
    """Several membranes as one batch: voxels and points one membrane after the other."""
    parts, groups, first, number = [], [], 0, 0
    for voxels in membranes:
        moved = voxels.coordinates.clone()
        moved[:, 0] += number
        parts.append(moved)
        groups.append(voxels.voxel_of_point + first)
        first += voxels.count
        number = int(moved[-1, 0]) + 1
    group = torch.cat(groups)
    return Voxels(
        coordinates=torch.cat(parts), voxel_of_point=group, points=segments(group, count=first)
    )


def spacing_mm(points_mm: np.ndarray, faces: np.ndarray | None = None) -> float:
    """Typical distance between neighbouring points [mm].

    With faces, the square root of the area per point, which is the edge of a square grid; without,
    the median distance to the nearest other point.

    Args:
        points_mm: Points [mm], shape (P, 3).
        faces: Triangles, shape (F, 3), or None.
    """
    expect(points_mm, "P 3", name="points_mm")
    if faces is not None:
        corners = points_mm[expect(faces, "F 3", name="faces")]
        edges = corners[:, 1:] - corners[:, :1]
        area_mm2 = 0.5 * np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=1).sum()
        return float(np.sqrt(area_mm2 / len(np.unique(faces))))
    from scipy.spatial import KDTree

    distances, _ = KDTree(points_mm).query(points_mm, k=2)
    return float(np.median(distances[:, 1]))


def voxel_edge_mm(points_mm: np.ndarray, faces: np.ndarray | None = None) -> float:
    """Edge of a voxel for these points [mm]: `VOXEL_PER_SPACING` times their spacing."""
    return VOXEL_PER_SPACING * spacing_mm(points_mm, faces)
