"""What a step of a training is fed: samples brought together, turned, over their scales.

`SkinFeed` keeps the whole skin of every sample on the device: a batch is one orientation of the
membrane (`frames`), so that all its samples share voxels and kernel maps. `PatchFeed` takes of each
sample the patch that the network will look at (`sim.forces.network.patches`) and lays the patches
of a batch side by side, each in an orientation and a place among the voxels of its own: a press is
seen in other voxels in every epoch, and a sample costs what is in it.

Errors are means over the whole skins in both: what a patch leaves out counts by its target there,
which a network that says nothing there misses. They are those of one look (`patches`): what is
measured in the end, by several, is better.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
import torch
from torch import Tensor

from sim.forces.network.kernel_maps import KernelMaps, kernel_maps, kernel_on
from sim.forces.network.patches import PatchFinder, leading_channels
from sim.forces.network.spec import NetworkSpec, Target
from sim.forces.network.turns import any_turn, value_matrix
from sim.forces.network.voxels import Voxels, join, voxelise
from sim.forces.training.arithmetic import room_for
from sim.forces.training.fields import Fields
from sim.forces.training.frames import Frame, frames_of


@dataclass(frozen=True, kw_only=True, slots=True)
class Scales:
    """What fields are divided by before they enter or leave the network."""

    input_mm: float
    force_N: float = 0.0
    """Of the contact solver's force; 0: it does not enter."""
    output: float
    """In the unit of the target; one for all channels, which turn into each other."""

    @property
    def inputs(self) -> tuple[float, ...]:
        """Of each vector that enters."""
        return (self.input_mm, self.force_N) if self.force_N else (self.input_mm,)


@dataclass(frozen=True, kw_only=True, slots=True)
class SeenSkin:
    """A skin at rest, and how a network looks at it."""

    points_mm: np.ndarray
    """Vertices [mm], shape (V, 3)."""
    voxel_mm: float
    """Edge of a voxel."""
    patch_mm: float = 0.0
    """Reach of a patch beyond where the contact solver's field is; 0: whole skins."""
    turns: int = 1
    """Orientations of whole skins."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Batch:
    """Samples that are computed together, on the device."""

    voxels: Voxels
    maps: KernelMaps
    inputs: Tensor
    """What enters, over its scale, shape (P, B, I)."""
    targets: Tensor
    """What is right, over its scale, shape (P, B, C)."""
    lengths: tuple[int, ...] = ()
    """Points of each sample where they lie one after the other and B is 1; what comes after them
    belongs to no sample."""
    missed: Tensor
    """Sum of the targets' sizes that are not among the points, of each sample, shape (S,)."""
    values: int
    """Of one sample that the mean error is over, those that are not among the points counted."""

    def errors(self, away: Tensor) -> Tensor:
        """Mean of each sample from the errors at the points (P, B, C), over the scale, (S,)."""
        if not self.lengths:
            sums = away.sum(dim=(0, 2))
        else:
            own = away[: sum(self.lengths)].split(self.lengths)
            sums = torch.stack([rows.sum() for rows in own])
        return (sums + self.missed) / self.values


class Feed(Protocol):
    """Samples of one skin."""

    def __len__(self) -> int: ...

    def batch(self, samples: Sequence[int], draw: int | None) -> Batch:
        """Samples by their numbers, turned as a random number says; None: as they are."""
        ...


class SkinFeed:
    """Whole skins."""

    def __init__(
        self, fields: Fields, frames: Sequence[Frame], scales: Scales, *, device: str
    ) -> None:
        self._frames = frames
        self._scales = scales
        self._input_scale = torch.tensor(scales.inputs, device=device).repeat_interleave(3)
        self._inputs, self._targets = _on(fields.inputs, device), _on(fields.targets, device)

    def __len__(self) -> int:
        return len(self._inputs)

    def batch(self, samples: Sequence[int], draw: int | None) -> Batch:
        """As `Feed`: of the orientations that there are, one for all samples."""
        frame = self._frames[0 if draw is None else draw % len(self._frames)]
        chosen = torch.tensor(samples, device=self._inputs.device)
        inputs, targets = self._inputs.index_select(0, chosen), self._targets[chosen]
        if draw is not None:
            inputs = (inputs.unflatten(2, (-1, 3)) @ frame.vectors.t()).flatten(2)
            targets = targets @ frame.values.t()
        return Batch(
            voxels=frame.voxels,
            maps=frame.maps,
            inputs=(inputs / self._input_scale).transpose(0, 1).contiguous(),
            targets=(targets / self._scales.output).transpose(0, 1),
            missed=torch.zeros(len(samples), device=inputs.device),
            values=targets[0].numel(),
        )


@dataclass(frozen=True, kw_only=True, slots=True)
class _Patch:
    """What is kept of a sample."""

    points: np.ndarray
    """Numbers of the points, shape (P,); none where nothing touches."""
    inputs: np.ndarray
    targets: np.ndarray
    missed: float
    """Sum of the targets' sizes outside, in the target's unit."""


class PatchFeed:
    """Patches, each turned on its own."""

    def __init__(
        self,
        fields: Fields,
        skin: SeenSkin,
        scales: Scales,
        *,
        spec: NetworkSpec,
        target: Target,
        device: str,
    ) -> None:
        """Find the patches.

        Args:
            fields: Of the samples.
            skin: Looked at in patches.
            scales: Of input and output.
            spec: Of the network.
            target: What is predicted.
            device: Where batches are computed.
        """
        self._points_mm, self._voxel_mm = skin.points_mm, skin.voxel_mm
        self._scales, self._device = scales, device
        self._spec, self._target = spec, target
        self._values = fields.targets[0].size if len(fields) else 0
        finder = PatchFinder(skin.points_mm, reach_mm=skin.patch_mm)
        leading = leading_channels(target, takes_force=scales.force_N > 0.0)
        self._patches = [
            _patch(finder.patch(given[:, leading]), given, wanted)
            for given, wanted in zip(fields.inputs, fields.targets, strict=True)
        ]

    def __len__(self) -> int:
        return len(self._patches)

    def batch(self, samples: Sequence[int], draw: int | None) -> Batch:
        """As `Feed`: each sample in an orientation of its own."""
        touching = [number for number in samples if len(self._patches[number].points)]
        parts = [self._turned(number, draw) for number in touching] or [self._untouched()]
        voxels = join([part[0] for part in parts]).to(self._device)
        kernel = kernel_on(self._device)
        missed = [self._patches[number].missed for number in samples]
        return Batch(
            voxels=voxels,
            maps=kernel_maps(voxels, stem_edge=self._spec.stem_edge, kernel=kernel),
            inputs=_on(np.concatenate([part[1] for part in parts])[:, None], self._device),
            targets=_on(np.concatenate([part[2] for part in parts])[:, None], self._device),
            lengths=tuple(len(self._patches[number].points) for number in samples),
            missed=torch.tensor(missed, device=self._device) / self._scales.output,
            values=self._values,
        )

    def _untouched(self) -> tuple[Voxels, np.ndarray, np.ndarray]:
        """A point for a batch in which nothing touches: a network takes no empty one."""
        voxels = voxelise(self._points_mm[:1], voxel_mm=self._voxel_mm)
        inputs = np.zeros((1, 3 * len(self._scales.inputs)))
        return voxels, inputs, np.zeros((1, self._target.channels))

    def _turned(self, number: int, draw: int | None) -> tuple[Voxels, np.ndarray, np.ndarray]:
        """Voxels, input and target over their scales of one sample."""
        own = self._patches[number]
        points_mm = self._points_mm[own.points]
        vectors = np.repeat(self._scales.inputs, 3)
        if draw is None:
            voxels = voxelise(points_mm, voxel_mm=self._voxel_mm)
            return voxels, own.inputs / vectors, own.targets / self._scales.output
        rng = np.random.default_rng([draw, number])
        matrix = any_turn(rng)
        voxels = voxelise(points_mm @ matrix.T, voxel_mm=self._voxel_mm, shift=rng.random(3))
        inputs = (own.inputs.reshape(len(points_mm), -1, 3) @ matrix.T).reshape(own.inputs.shape)
        targets = own.targets @ value_matrix(matrix, self._target).T
        return voxels, inputs / vectors, targets / self._scales.output


def feeds(
    groups: Sequence[Fields],
    skin: SeenSkin,
    scales: Scales,
    *,
    spec: NetworkSpec,
    target: Target,
    device: str,
) -> list[Feed]:
    """Feeds of groups of samples on one skin, whole or in patches.

    Args:
        groups: Samples to train on, samples to validate with.
        skin: Of all samples.
        scales: Of input and output.
        spec: Of the network.
        target: What is predicted.
        device: `cpu` or `cuda`.

    Raises:
        DesignError: If the points make no membrane.
        DeviceError: If the device has no room for whole skins.
    """
    with room_for(device):
        if skin.patch_mm:
            return [
                PatchFeed(fields, skin, scales, spec=spec, target=target, device=device)
                for fields in groups
            ]
        frames = frames_of(
            skin.points_mm,
            voxel_mm=skin.voxel_mm,
            spec=spec,
            target=target,
            turns=skin.turns,
            device=device,
        )
        return [SkinFeed(fields, frames, scales, device=device) for fields in groups]


def _patch(points: np.ndarray, given: np.ndarray, wanted: np.ndarray) -> _Patch:
    missed = np.abs(wanted).sum(dtype=np.float64) - np.abs(wanted[points]).sum(dtype=np.float64)
    return _Patch(
        points=points, inputs=given[points], targets=wanted[points], missed=max(float(missed), 0.0)
    )


def _on(values: np.ndarray, device: str) -> Tensor:
    return torch.from_numpy(np.ascontiguousarray(values, dtype=np.float32)).to(device)
