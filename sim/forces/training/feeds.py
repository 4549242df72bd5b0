"""What a step of a training is fed: samples brought together, turned, over their scales.

`SkinFeed` keeps the whole skin of every sample on the device: a batch is one orientation of the
membrane (`frames`), so that all its samples share voxels and kernel maps; it knows one membrane.
`PatchFeed` takes of each sample the patch that the network will look at
(`sim.forces.network.patches`) and lays the patches of a batch side by side, each in an orientation
and a place among the voxels of its own: a press is seen in other voxels in every epoch, a sample
costs what is in it, and patches of several membranes lie in one batch.

Errors are means over the whole skins in both: what a patch leaves out counts by its target there,
which a network that says nothing there misses. They are those of one look (`patches`): what is
measured in the end, by several, is better.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
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
from workbench.core.base.errors import DesignError


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
    values: Tensor
    """How many values of each sample the mean error is over, those that are not among the points
    counted, shape (S,)."""
    sizes: Tensor
    """Size of what is to be found in the end at each point, over that of its sample's largest,
    shape (P, B, 1): what a correction is added to takes part."""

    def errors(self, away: Tensor) -> Tensor:
        """Mean of each sample from the errors at the points (P, B, C), over the scale, (S,)."""
        if not self.lengths:
            sums = away.sum(dim=(0, 2))
        else:
            own = away[: sum(self.lengths)].split(self.lengths)
            sums = torch.stack([rows.sum() for rows in own])
        return (sums + self.missed) / self.values


class Feed(Protocol):
    """Samples, by their numbers."""

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
        self._sizes = _on(fields.sizes[..., None], device)

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
            values=torch.full((len(samples),), targets[0].numel(), device=inputs.device),
            sizes=self._sizes[chosen].transpose(0, 1),
        )


@dataclass(frozen=True, kw_only=True, slots=True)
class _Patch:
    """What is kept of a sample."""

    places: np.ndarray
    """The points over the edge of a voxel, shape (P, 3); none where nothing touches."""
    inputs: np.ndarray
    targets: np.ndarray
    sizes: np.ndarray
    """Of what is to be found in the end, over the largest of the sample, shape (P, 1)."""
    missed: float
    """Sum of the targets' sizes outside, in the target's unit."""
    values: int
    """Of the sample's targets, inside and outside."""


class PatchFeed:
    """Patches, each turned on its own."""

    def __init__(
        self,
        groups: Sequence[tuple[Fields, SeenSkin]],
        scales: Scales,
        *,
        spec: NetworkSpec,
        target: Target,
        device: str,
    ) -> None:
        """Find the patches.

        Args:
            groups: Samples skin by skin, numbered through, and their skins, looked at in patches.
            scales: Of input and output.
            spec: Of the network.
            target: What is predicted.
            device: Where batches are computed.
        """
        self._scales, self._device = scales, device
        self._spec, self._target = spec, target
        leading = leading_channels(target, takes_force=scales.force_N > 0.0)
        self._patches = [
            patch for fields, skin in groups for patch in _patches(fields, skin, leading)
        ]

    def __len__(self) -> int:
        return len(self._patches)

    def batch(self, samples: Sequence[int], draw: int | None) -> Batch:
        """As `Feed`: each sample in an orientation of its own."""
        touching = [number for number in samples if len(self._patches[number].places)]
        parts = [self._turned(number, draw) for number in touching] or [self._untouched()]
        voxels = join([part[0] for part in parts]).to(self._device)
        kernel = kernel_on(self._device)
        own = [self._patches[number] for number in samples]
        missed = torch.tensor([patch.missed for patch in own], device=self._device)
        return Batch(
            voxels=voxels,
            maps=kernel_maps(voxels, stem_edge=self._spec.stem_edge, kernel=kernel),
            inputs=_on(np.concatenate([part[1] for part in parts])[:, None], self._device),
            targets=_on(np.concatenate([part[2] for part in parts])[:, None], self._device),
            lengths=tuple(len(patch.places) for patch in own),
            missed=missed / self._scales.output,
            values=torch.tensor([patch.values for patch in own], device=self._device),
            sizes=_on(np.concatenate([part[3] for part in parts])[:, None], self._device),
        )

    def _untouched(self) -> tuple[Voxels, np.ndarray, np.ndarray, np.ndarray]:
        """A point for a batch in which nothing touches: a network takes no empty one."""
        voxels = voxelise(np.zeros((1, 3)), voxel_mm=1.0)
        inputs = np.zeros((1, 3 * len(self._scales.inputs)))
        return voxels, inputs, np.zeros((1, self._target.channels)), np.zeros((1, 1))

    def _turned(
        self, number: int, draw: int | None
    ) -> tuple[Voxels, np.ndarray, np.ndarray, np.ndarray]:
        """Voxels, input and target over their scales, and sizes of one sample."""
        own = self._patches[number]
        vectors = np.repeat(self._scales.inputs, 3)
        if draw is None:
            voxels = voxelise(own.places, voxel_mm=1.0)
            return voxels, own.inputs / vectors, own.targets / self._scales.output, own.sizes
        rng = np.random.default_rng([draw, number])
        matrix = any_turn(rng)
        voxels = voxelise(own.places @ matrix.T, voxel_mm=1.0, shift=rng.random(3))
        inputs = (own.inputs.reshape(len(own.places), -1, 3) @ matrix.T).reshape(own.inputs.shape)
        targets = own.targets @ value_matrix(matrix, self._target).T
        return voxels, inputs / vectors, targets / self._scales.output, own.sizes


def feeds(
    parts: Sequence[Sequence[tuple[Fields, SeenSkin]]],
    scales: Scales,
    *,
    spec: NetworkSpec,
    target: Target,
    device: str,
) -> list[Feed]:
    """Feeds of parts of the data, of whole skins or in patches.

    Args:
        parts: Samples to train on, samples to validate with, each skin by skin.
        scales: Of input and output.
        spec: Of the network.
        target: What is predicted.
        device: `cpu` or `cuda`.

    Raises:
        DesignError: If the points make no membrane, or whole skins are not of one.
        DeviceError: If the device has no room for whole skins.
    """
    skins = [skin for groups in parts for _, skin in groups]
    with room_for(device):
        if all(skin.patch_mm for skin in skins):
            return [
                PatchFeed(groups, scales, spec=spec, target=target, device=device)
                for groups in parts
            ]
        if any(len(groups) > 1 for groups in parts):
            raise DesignError(
                f"{len(parts[0])} membranes, and whole skins are looked at",
                hint="choose a preset that looks at patches (small), or train on one membrane",
                at="data",
            )
        frames = frames_of(
            skins[0].points_mm,
            voxel_mm=skins[0].voxel_mm,
            spec=spec,
            target=target,
            turns=skins[0].turns,
            device=device,
        )
        return [SkinFeed(groups[0][0], frames, scales, device=device) for groups in parts]


def _patches(fields: Fields, skin: SeenSkin, leading: slice) -> Iterator[_Patch]:
    """The patches of the samples of a skin, around where the channels of the leading field are."""
    finder = PatchFinder(skin.points_mm, reach_mm=skin.patch_mm)
    samples = zip(fields.inputs, fields.targets, fields.sizes, strict=True)
    for given, wanted, sizes in samples:
        points = finder.patch(given[:, leading])
        inside = np.abs(wanted[points]).sum(dtype=np.float64)
        missed = float(np.abs(wanted).sum(dtype=np.float64) - inside)
        yield _Patch(
            places=skin.points_mm[points] / skin.voxel_mm,
            inputs=given[points],
            targets=wanted[points],
            sizes=sizes[points, None],
            missed=max(missed, 0.0),
            values=wanted.size,
        )


def _on(values: np.ndarray, device: str) -> Tensor:
    return torch.from_numpy(np.ascontiguousarray(values, dtype=np.float32)).to(device)
