"""A learned reader in use: photographs in, maps and force out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import torch

from sim.reading.network.given import given
from sim.reading.network.loss import LOG_RANGE
from sim.reading.network.reader_file import ReaderFile
from sim.reading.network.spec import (
    DEPTH,
    LOG_VARIANCE,
    PRESSURE,
    SURFACE,
    TOUCH,
    TURN,
    Scales,
)
from sim.reading.network.unet import UNet, channels_last, network_of


@dataclass(frozen=True, kw_only=True, slots=True)
class Told:
    """What a network says of B photographs, in its own size H x W."""

    depth_mm: np.ndarray
    """Inward displacement of the skin that a pixel sees, shape (B, H, W), float32."""
    surface_mm: np.ndarray
    """Of the skin over the place that it saw at rest, shape (B, H, W)."""
    turn: np.ndarray
    """Change of the inward unit normal, shape (B, H, W, 3)."""
    contact: np.ndarray
    """Whether it is pressed in, as likely as not, shape (B, H, W), bool."""
    pressure_MPa: np.ndarray
    """Contact pressure, shape (B, H, W)."""
    sigma_mm: np.ndarray
    """Standard deviation of the depth, shape (B, H, W)."""
    force_N: np.ndarray
    """On the membrane in the sensor frame, shape (B, 3)."""
    force_sigma_N: np.ndarray
    """Standard deviation of its size, shape (B,)."""


class Predictor:
    """A network for use, on one device."""

    def __init__(self, reader: ReaderFile, device: str = "cpu") -> None:
        self.reader = reader
        self.device = device
        state = {
            name: torch.from_numpy(np.ascontiguousarray(a)) for name, a in reader.arrays.items()
        }
        network = network_of(reader.spec, state).to(device)
        self.network: UNet = channels_last(network)

    def read(self, idle: np.ndarray, photos: np.ndarray) -> Told:
        """Read photographs of the network's size.

        Args:
            idle: At rest [grey], shape (H, W, 3).
            photos: Touched, shape (B, H, W, 3).
        """
        with torch.inference_mode():
            enters = given(self._tensor(idle[None]), self._tensor(photos))
            maps, force = self.network(enters.contiguous(memory_format=torch.channels_last))
            return told(maps[:, :, : photos.shape[1]], force, self.reader.scales)

    def _tensor(self, images: np.ndarray) -> torch.Tensor:
        # Whole grey levels travel to the device as bytes.
        found = torch.from_numpy(np.ascontiguousarray(images)).to(self.device)
        return found.float().permute(0, 3, 1, 2)


def told(maps: torch.Tensor, force: torch.Tensor, scales: Scales) -> Told:
    """A network's numbers in units, (B, OUTPUTS, H, W) and (B, 4)."""
    maps, force = maps.float(), force.float()
    numbers = _on_host if maps.is_cuda else torch.Tensor.numpy
    variance = maps[:, LOG_VARIANCE].clamp(*LOG_RANGE)
    force_sigma = torch.exp(0.5 * force[:, 3].clamp(*LOG_RANGE))
    pressure_MPa = scales.pressure_MPa * maps[:, PRESSURE].clamp(min=0.0)
    found = Told(
        depth_mm=numbers(maps[:, DEPTH]),
        surface_mm=numbers(maps[:, SURFACE]),
        turn=numbers(maps[:, TURN].permute(0, 2, 3, 1)),
        contact=numbers(maps[:, TOUCH] > 0.0),
        pressure_MPa=numbers(pressure_MPa),
        sigma_mm=numbers(scales.sigma * torch.exp(0.5 * variance)),
        force_N=numbers(scales.force_N * force[:, :3]),
        force_sigma_N=numbers(scales.force_N * scales.force_sigma * force_sigma),
    )
    if maps.is_cuda:
        torch.cuda.synchronize(maps.device)
    return found


def _on_host(values: torch.Tensor) -> np.ndarray:
    """Numbers of the device, there once it is synchronised.

    Memory that is locked takes 630 MB from an H100 in 12 ms, other memory in .49 s.
    """
    found = torch.empty(values.shape, dtype=values.dtype, pin_memory=True)
    found.copy_(values, non_blocking=True)
    return found.numpy()


def in_size(images: Sequence[np.ndarray], columns: int, rows: int) -> np.ndarray:
    """Photographs (h, w, 3) in a network's size, shape (B, rows, columns, 3); float32 where their
    own was another."""
    import cv2

    found = []
    for image in images:
        if image.shape[:2] == (rows, columns):
            found.append(image)
            continue
        smaller = image.shape[1] > columns
        how = cv2.INTER_AREA if smaller else cv2.INTER_LINEAR
        found.append(cv2.resize(image.astype(np.float32), (columns, rows), interpolation=how))
    return np.stack(found)
