"""The membrane in several orientations: exact new samples from old ones.

Turning or mirroring skin, object and fields together is physics that happens as well: an isotropic
elastic body has no direction of its own, and gravity is left out. So a state seen in another
orientation is a state of another membrane, and the network, which sees voxels, learns that azimuth
does not matter. Turn k of K is the angle 2 pi k / K about the sensor's axis, every second one
mirrored in the plane y = 0 first. What is not invariant is the solvers' mesh: its noise turns too.

Scaling a field is not exact, contact is not linear: it is left out.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import torch
from torch import Tensor

from sim.forces.network.kernel_maps import Kernel, KernelMaps, kernel_maps
from sim.forces.network.spec import NetworkSpec, Target
from sim.forces.network.voxels import Voxels, voxelise

SYMMETRIC = ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0))
"""Places in a matrix of the six of a stress: xx, yy, zz, xy, yz, zx."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Frame:
    """One orientation, on the device that computes."""

    voxels: Voxels
    maps: KernelMaps
    vectors: Tensor
    """Takes a vector of the sensor frame into this one, shape (3, 3), to multiply from the left."""
    values: Tensor
    """The same for a value of the target, shape (C, C)."""


def turn_matrix(turn: int, turns: int) -> np.ndarray:
    """Orthogonal matrix of a turn, shape (3, 3)."""
    return about_axis(2.0 * math.pi * turn / turns, mirrored=bool(turn % 2))


def about_axis(angle_rad: float, *, mirrored: bool) -> np.ndarray:
    """Turn about z, after the mirror in the plane y = 0 where asked, shape (3, 3)."""
    cosine, sine = math.cos(angle_rad), math.sin(angle_rad)
    turned = np.array([[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]])
    return turned @ np.diag([1.0, -1.0, 1.0]) if mirrored else turned


def any_turn(rng: np.random.Generator) -> np.ndarray:
    """Orthogonal matrix of any angle about the sensor's axis, every second one mirrored, (3, 3)."""
    return about_axis(rng.uniform(0.0, 2.0 * math.pi), mirrored=bool(rng.integers(2)))


def value_matrix(matrix: np.ndarray, target: Target) -> np.ndarray:
    """What a turn does to the numbers of a target, shape (C, C): itself, or T S T^t of a stress."""
    if target is not Target.STRESS:
        return matrix
    columns = []
    for i, j in SYMMETRIC:
        unit = np.zeros((3, 3))
        unit[i, j] = unit[j, i] = 1.0
        whole = matrix @ unit @ matrix.T
        columns.append([whole[place] for place in SYMMETRIC])
    return np.array(columns).T


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
    kernel = Kernel.PAIRS if device == "cpu" else Kernel.GATHER
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
