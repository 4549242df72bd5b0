"""Sizes of the block around a cast, in the local frame of the mould."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from geometry.body import csg
from geometry.mould.cast import Cast
from geometry.mould.parting import Parting
from workbench.core.design.making import MouldOptions

EAR_MM = 17.0
"""Room beside the body for a key and a bolt, with walls of 3 mm."""
LUG_HEIGHT_MM = 4.0
LUG_TO_BOLT_MM = 4.2
"""From a lug to the axis of the bolt above it [mm]: leaves a wall of more than 2 mm."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Layout:
    """What is made around the body, in the local frame."""

    low: np.ndarray
    """Lower corner of the body's bounding box [mm], shape (3,)."""
    high: np.ndarray
    """Upper corner, shape (3,)."""
    radius_mm: float
    """Largest distance of the body from the parting's middle."""
    parting: Parting
    options: MouldOptions

    @property
    def ear_mm(self) -> float:
        """Width of the block beside the body."""
        return max(EAR_MM, self.options.wall_mm)

    @property
    def half_mm(self) -> np.ndarray:
        """Half widths of the block in x and y [mm], shape (2,)."""
        if self.round:
            return np.full(2, self.radius_mm + self.ear_mm)
        margin = np.array([self.options.wall_mm, self.ear_mm])
        return (self.high - self.low)[:2] / 2 + margin

    @property
    def middle(self) -> np.ndarray:
        """Axis of the block, shape (2,)."""
        return self.parting.middle_mm

    @property
    def round(self) -> bool:
        """Whether the block is a cylinder."""
        return self.parting.count > 2

    @property
    def base_mm(self) -> float:
        """Height of the base plane [mm]."""
        return float(self.low[2])

    @property
    def top_mm(self) -> float:
        """Height of the block's top [mm]."""
        return float(self.high[2]) + self.options.wall_mm

    @property
    def bolt_mm(self) -> float:
        """Height of the bolts [mm]."""
        return (self.base_mm + self.top_mm) / 2

    @property
    def lug_mm(self) -> float:
        """Height of the lugs over the base plane [mm]; low blocks leave room for the bolts."""
        return min(LUG_HEIGHT_MM, self.bolt_mm - self.base_mm - LUG_TO_BOLT_MM)


def make_layout(cast: Cast, parting: Parting, options: MouldOptions) -> Layout:
    """Sizes of the mould around a cast."""
    local = cast.outer.points_mm @ csg.turn_z(parting.azimuth_deg)
    return Layout(
        low=local.min(axis=0),
        high=local.max(axis=0),
        radius_mm=float(np.linalg.norm(local[:, :2] - parting.middle_mm, axis=1).max()),
        parting=parting,
        options=options,
    )
