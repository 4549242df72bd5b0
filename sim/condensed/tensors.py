"""What fast contact felt, as tensors of PyTorch on the device that computed it.

Nothing goes through the processor's memory: a learner that trains on the same GPU reads them there.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from sim.condensed import bundles, tensor_kernels
from sim.condensed.surface import Surface
from sim.optics.light import copy_kernels
from sim.optics.light.device_arrays import on_device
from sim.optics.light.tensor_device import tensor_device

if TYPE_CHECKING:
    import torch


@dataclass(frozen=True, kw_only=True, slots=True)
class TouchTensors:
    """`Touch` of B presses on a skin of N nodes, float32."""

    totals: torch.Tensor
    """Numbers of each press, (B, `bundles.TOTALS`)."""
    displacement_mm: torch.Tensor
    """(B, N, 3)."""
    pressure_MPa: torch.Tensor
    """(B, N)."""


def touch_tensors(felt: Any, presses: int, nodes: int) -> TouchTensors:
    """Copies of a `bundles.Felt`: the next frame does not change them."""
    import torch

    device = tensor_device()
    totals = torch.empty(presses * bundles.TOTALS, device=device)
    pressure = torch.empty(presses * nodes, device=device)
    displacement = torch.empty((presses * nodes, 3), device=device)
    copy_kernels.copy_numbers(felt.totals, totals)
    copy_kernels.copy_numbers(felt.pressure, pressure)
    copy_kernels.copy_vectors(felt.displacement, displacement)
    return TouchTensors(
        totals=totals.reshape(presses, bundles.TOTALS),
        displacement_mm=displacement.reshape(presses, nodes, 3),
        pressure_MPa=pressure.reshape(presses, nodes),
    )


class SurfaceTensors:
    """A `Surface` on the device."""

    def __init__(self, surface: Surface) -> None:
        self._nodes = on_device(surface.nodes)
        self._weights = on_device(surface.weights)
        self._vertices = len(surface.nodes)

    def displacement_mm(self, of_nodes_mm: torch.Tensor) -> torch.Tensor:
        """Displacement of the vertices, (B, V, 3), from that of nodes, (B, N, 3)."""
        found = of_nodes_mm.new_empty((len(of_nodes_mm), self._vertices, 3))
        tensor_kernels.follow(self._nodes, self._weights, of_nodes_mm, found)
        return found
