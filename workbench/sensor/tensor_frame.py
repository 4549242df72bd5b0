"""A `Frame` of tensors: what a sensor feels and sees, left on the device that computed it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sim.condensed import bundles
from sim.condensed.surface import Surface
from sim.condensed.tensors import SurfaceTensors, TouchTensors
from sim.optics.raster.imager import Imager
from sim.optics.raster.tensor_images import TensorImages
from workbench.sensor.frame import Seen

if TYPE_CHECKING:
    import torch


@dataclass(frozen=True, kw_only=True)
class TensorFelt:
    """As `Felt`, of B presses: tensors of float32, `within_range` of bool."""

    force_N: torch.Tensor
    torque_Nmm: torch.Tensor
    displacement_mm: torch.Tensor
    pressure_MPa: torch.Tensor
    slip: torch.Tensor
    within_range: torch.Tensor


@dataclass(frozen=True, kw_only=True)
class TensorFrame(Seen["torch.Tensor"], TensorFelt):
    """As `Frame`, of tensors."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Range:
    """Between which presses the forces were fitted."""

    deepest: float
    """Indentation over the wall."""
    unsettled_mm: float
    """Change of the last round beyond which a frame is not settled [mm]."""
    fewest: int
    """Nodes that touch below which forces are coarse."""


def felt_tensors(touch: TouchTensors, arms_mm: np.ndarray, within: Range) -> TensorFelt:
    """Names for what was felt; `arms_mm` as `Thing.arms_mm`, (B, 3)."""
    import torch

    totals = touch.totals
    force = totals[:, bundles.FORCE : bundles.FORCE + 3]
    arms = torch.from_numpy(arms_mm.astype(np.float32)).to(totals.device)
    touching = totals[:, bundles.TOUCHING]
    settled = totals[:, bundles.MOVED] <= within.unsettled_mm
    shallow = (totals[:, bundles.DEEPEST] <= within.deepest) | (touching == 0)
    return TensorFelt(
        force_N=force,
        torque_Nmm=totals[:, bundles.MOMENT : bundles.MOMENT + 3] + torch.cross(arms, force, dim=1),
        displacement_mm=touch.displacement_mm,
        pressure_MPa=touch.pressure_MPa,
        slip=totals[:, bundles.SLIDING],
        within_range=settled & shallow & ((touching == 0) | (touching >= within.fewest)),
    )


class TensorEye:
    """Draws what nodes of the skin did, on the device."""

    def __init__(self, surface: Surface, imager: Imager, rest_depth_mm: np.ndarray) -> None:
        self._surface = SurfaceTensors(surface)
        self._images = TensorImages(imager, rest_depth_mm)

    def frame(self, felt: TensorFelt) -> TensorFrame:
        """The same with what the camera sees."""
        moved = self._surface.displacement_mm(felt.displacement_mm)
        return TensorFrame(
            **vars(felt), rgb=self._images.images(moved), looks=lambda: self._images.looks(moved)
        )
