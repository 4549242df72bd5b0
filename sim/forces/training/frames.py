"""The membrane in several orientations: exact new samples from old ones.

Turning or mirroring skin, object and fields together is physics that happens as well: an isotropic
elastic body has no direction of its own, and gravity is left out. So a state seen in another
orientation is a state of another membrane, and the network, which sees voxels, learns that azimuth
does not matter. Turn k of K is the angle 2 pi k / K about the sensor's axis, every second one
mirrored in the plane y = 0 first. What is not invariant is the solvers' mesh: its noise turns too.

Scaling a field is not exact, contact is not linear: it is left out.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import torch
from torch import Tensor

from sim.forces.network.kernel_maps import KernelMaps, kernel_maps, kernel_on
from sim.forces.network.spec import NetworkSpec, Target
from sim.forces.network.turns import turn_matrix, value_matrix
from sim.forces.network.voxels import Voxels, voxelise


@dataclass(frozen=True, kw_only=True, slots=True)
class Frame:
    """One orientation, on the device that computes."""

    voxels: Voxels
    maps: KernelMaps
    vectors: Tensor
    """Takes a vector of the sensor frame into this one, shape (3, 3), to multiply from the left."""
    values: Tensor
    """The same for a value of the target, shape (C, C)."""


def frames_of(
    points_mm: np.ndarray,
    *,
    voxel_mm: float,
    spec: NetworkSpec,
    target: Target,
    turns: int,
    device: str,
) -> tuple[Frame, ...]:
    """All orientations of a membrane; the first is that of the sensor.

    Raises:
        DesignError: If the points make no membrane.
        torch.OutOfMemoryError: If the device has no room for them.
    """
    kernel = kernel_on(device)
    found = []
    for turn in range(turns):
        matrix = turn_matrix(turn, turns)
        voxels = voxelise(points_mm @ matrix.T, voxel_mm=voxel_mm).to(device)
        found.append(
            Frame(
                voxels=voxels,
                maps=kernel_maps(voxels, stem_edge=spec.stem_edge, kernel=kernel),
                vectors=_on(matrix, device),
                values=_on(value_matrix(matrix, target), device),
            )
        )
    return tuple(found)


def _on(matrix: np.ndarray, device: str) -> Tensor:
    return torch.from_numpy(matrix.astype(np.float32)).to(device)
