"""A trained network in use: displacement of a skin in, field at the same points out, every frame.

For networks that look at the whole skin; those that look at a patch of it are in `patches`.

Voxels and kernel maps of the membrane are found once. Normalisation is folded into the
convolutions. How the products are computed follows rules that were measured (`kernel_maps`,
`products`):

| device | type | products |
|---|---|---|
| CPU with bfloat16 instructions | bfloat16 | pairs at large and wide levels, else gathered |
| other CPU, or `Precision.SINGLE` | float32 | pairs |
| CUDA | float16, or float32 if asked | gathered, compiled and recorded |

In bfloat16 single values of a press differ from float32 by up to 0.9 % of the largest, the sum of
all differences is 2.8 % of that of the values (rows `learned_half_`); float16 is ten times finer.
That is for the screen, not for results that are kept nor for the tables of an evaluation, which ask
for `Precision.SINGLE`. Products add up in float32 in every type.

On a CPU with AMX, both of whose cores other programs used, a frame of the published network took
20, 54 and 250 ms of one core at 1,000, 5,000 and 25,000 points in bfloat16; 36, 110 and 540 in
float32.

Left out: whether the membrane is one that the weights know; that is for the caller, from the data
card.
"""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from enum import StrEnum

import numpy as np
import torch
from torch import Tensor

from sim.forces.network.acceleration import Acceleration, Computation, accelerated
from sim.forces.network.folding import folded
from sim.forces.network.inputs import corrected_channels, finite_batch
from sim.forces.network.kernel_maps import Kernel, KernelMaps, kernel_maps
from sim.forces.network.minkunet import network_of
from sim.forces.network.spec import DEPTH, NetworkSpec
from sim.forces.network.voxels import Voxels, spacing_mm, voxelise
from sim.forces.network.weights import NetworkWeights
from workbench.core.base.errors import DesignError, DeviceError, SolveError

HALF_PAIRS_FROM = 20_000_000
"""Voxels times width squared of a level from which pairs pay in bfloat16 on a CPU. What they save
grows with it, what they cost is a call for each offset. Measured on one core, pairs against
gathering: the published network at 1,000 points (1e7) 14 against 12 ms, its finest level at 5,000
(5e7) 3 against 9 ms; the small network at 5,000 points (5e6) 18 against 11 ms, at 25,000 (2.5e7) 50
against 54 ms."""
HALF_BLOCK_VOXELS = 8192
"""Voxels of a block there: rows are half as long, and each product costs a fixed 10 us."""
MOST_RECORDED = 4
"""Batch sizes that are recorded; further ones run kernel by kernel."""


class Precision(StrEnum):
    """Type of the features between input and output."""

    AUTO = "auto"
    """`HALF` where the device has instructions for it."""
    SINGLE = "single"
    HALF = "half"
    """bfloat16 on a CPU, float16 on a CUDA device."""


class Predictor:
    """A network on one membrane; keep it as long as the membrane.

    Attributes:
        voxels: Of the membrane.
        dtype: Type of the features.
        acceleration: How the kernels of the last new batch size are launched.
        notes: What the user should know about how it runs; empty when all is well.
    """

    def __init__(
        self,
        weights: NetworkWeights,
        points_mm: np.ndarray,
        *,
        faces: np.ndarray | None = None,
        device: str = "cpu",
        precision: Precision = Precision.AUTO,
        acceleration: Acceleration = Acceleration.AUTO,
    ) -> None:
        """Prepare the network for a membrane.

        Args:
            weights: Of the trained network.
            points_mm: Points of the skin at rest [mm], shape (V, 3).
            faces: Triangles between them, shape (F, 3); they tell the spacing best.
            device: `cpu` or `cuda`.
            precision: Type of the features.
            acceleration: On a CUDA device: what may be compiled and recorded.

        Raises:
            DesignError: If the points make no membrane, or the weights look at patches.
            DeviceError: If the device has no room for the network.
            StoreError: If the weights do not fit their own description.
        """
        if weights.patch_spacings:
            raise DesignError(
                "these weights look at patches, not at the whole skin",
                hint="let steady_predictor choose what predicts with them",
                at="weights",
            )
        self.weights = weights
        self.notes: tuple[str, ...] = ()
        self.acceleration = Acceleration.EAGER
        self.dtype = working_type(device, precision)
        self._device = device
        self._wanted = acceleration
        self._by_samples: dict[int, Computation] = {}
        voxel_mm = weights.voxel_per_spacing * spacing_mm(points_mm, faces)
        with room_on(device):
            self.voxels = voxelise(points_mm, voxel_mm=voxel_mm).to(device)
            self._maps = maps_for_use(self.voxels, self.dtype, weights.spec)
            self._network = folded(network_of(weights)).to(device=device, dtype=self.dtype)
            self._scale = torch.tensor(weights.output_scale, device=device)
            self._input_scale = torch.tensor(weights.input_scale, device=device)

    def predict(self, given: np.ndarray) -> np.ndarray:
        """The field at the points, in the unit of the weights' target.

        Args:
            given: Displacement of the points [mm], and the contact solver's force [N] where the
                network asks for it (`inputs.given_field`), shape (V, I), or (B, V, I) for several
                samples at once; I is 3 or 6.

        Returns:
            Shape (V, C) or (B, V, C), float32.

        Raises:
            SolveError: If a number of what is given is not finite, or the field is not.
            DeviceError: If the device runs out of memory.
        """
        points, channels = len(self.voxels.voxel_of_point), len(self.weights.input_scale)
        batch = finite_batch(given, points=points, channels=channels)
        with room_on(self._device), torch.no_grad():
            field = self._field(np.ascontiguousarray(batch.swapaxes(0, 1), dtype=np.float32))
        if not np.isfinite(field).all():
            raise SolveError(
                f"the network's field is not finite in {str(self.dtype).removeprefix('torch.')}",
                hint="use precision=single, or other weights",
                at="precision",
            )
        result = np.ascontiguousarray(field.swapaxes(0, 1))
        return result if given.ndim == 3 else result[0]

    def _field(self, given: np.ndarray) -> np.ndarray:
        """Field of all samples, shape (V, B, C) from (V, B, I)."""
        there = torch.from_numpy(given).to(self._device)
        return self._computation(there)(there).cpu().numpy()

    def _computation(self, given: Tensor) -> Computation:
        """Everything that happens on the device, for so many samples."""
        samples = given.shape[1]
        if samples not in self._by_samples:
            full = len(self._by_samples) >= MOST_RECORDED
            wanted = Acceleration.EAGER if full else self._wanted
            run, self.acceleration, note = accelerated(self._on_device, given, acceleration=wanted)
            if note and note not in self.notes:
                self.notes += (note,)
            if full:
                return run
            self._by_samples[samples] = run
        return self._by_samples[samples]

    def _on_device(self, given: Tensor) -> Tensor:
        """From points to points, shape (V, B, C) from (V, B, I)."""
        features = self.voxels.mean(given / self._input_scale)
        values = self._network(features.to(self.dtype), self._maps)
        found = self.voxels.to_points(values.float() * self._scale)
        if not self.weights.corrects:
            return found
        return found + given[..., corrected_channels(self.weights.target)]


def working_type(device: str, precision: Precision) -> torch.dtype:
    """The type of features on a device, by the table above."""
    if precision is Precision.SINGLE:
        return torch.float32
    if device != "cpu":
        return torch.float16
    if precision is Precision.HALF or _multiplies_bfloat16():
        return torch.bfloat16
    return torch.float32


def _multiplies_bfloat16() -> bool:
    """Whether the CPU has instructions for it; without, it is slower than float32."""
    able = torch.cpu.get_capabilities()
    return any(able.get(name, False) for name in ("avx512_bf16", "amx_bf16", "bf16"))


def maps_for_use(voxels: Voxels, dtype: torch.dtype, spec: NetworkSpec) -> KernelMaps:
    """Kernel maps for one frame after the other, by the table above."""
    if voxels.coordinates.device.type != "cpu":
        return kernel_maps(voxels, stem_edge=spec.stem_edge, kernel=Kernel.GATHER)
    if dtype is not torch.bfloat16:
        return kernel_maps(voxels, stem_edge=spec.stem_edge)
    widths = spec.planes[: DEPTH - 2 : -1]
    return kernel_maps(
        voxels,
        stem_edge=spec.stem_edge,
        block_voxels=HALF_BLOCK_VOXELS,
        pairs_from=[HALF_PAIRS_FROM // width**2 for width in widths],
    )


@contextlib.contextmanager
def room_on(device: str) -> Iterator[None]:
    """Names the remedy when the device runs out of memory."""
    try:
        yield
    except torch.OutOfMemoryError as error:
        raise DeviceError(
            f"the {device} device has no memory left for the network",
            hint="predict fewer samples at once, close what else uses the device, "
            "or set WORKBENCH_DEVICE=cpu",
            at="device",
        ) from error
